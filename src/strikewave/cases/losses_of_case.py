"""Where a case loses energy, and how well each loss factor is held over its band."""

from __future__ import annotations

from strikewave.base import declare
from strikewave.base.declare import KEY
from strikewave.base.shock_quantities import FREQUENCY, RATIO
from strikewave.cases.case import Case
from strikewave.cases.sensors_of_case import build_channels
from strikewave.cases.stack_of_case import fitted, layer_loss, matter_of


@declare.dataclass
class FittedLoss:
    """A loss factor held by springs and dashpots over a band of frequencies."""

    where: str = declare.word("what loses energy", column=KEY)
    loss_factor: float = declare.number(RATIO, "its loss factor in the case")
    error: float = declare.number(RATIO, "by how much of it the springs and dashpots miss it at most")
    low: float = declare.number(FREQUENCY, "low end of the band")
    high: float = declare.number(FREQUENCY, "high end of the band")


def fitted_losses(case: Case) -> tuple[FittedLoss, ...]:
    """Return the losses of layers, of gaskets between layers, and of gaskets under sensors.

    Examples
    --------
    >>> from strikewave import load_case
    >>> fitted_losses(load_case("li-ma-2019-fig13-bar", ["stack.layer.lower.loss_factor=0.1"]))[0].loss_factor
    0.1
    """
    losses = []
    for layer in case.stack.layer:
        fit = layer_loss(layer, f"stack.layer.{layer.name}")
        if fit is not None and layer.loss_factor is not None:
            losses.append(FittedLoss(layer.name, layer.loss_factor.si, fit.error, *fit.band))
    for joint in case.stack.joint:
        path = f"stack.joint.{joint.after}"
        eta = matter_of(joint, path).loss_factor if joint.kind == "gasket" else None
        if eta:
            fit = fitted(joint, path, 1.0, eta)
            losses.append(FittedLoss(f"gasket after {joint.after}", eta, fit.error, *fit.band))
    for channel in build_channels(case):
        mounting = channel.sensor.mounting
        for k, gasket in enumerate(mounting.gaskets):
            if gasket.loss_factor:
                fit = mounting.loss(gasket)
                where = f"gasket {k + 1} under {channel.sensor.name}"
                losses.append(FittedLoss(where, gasket.loss_factor, fit.error, *fit.band))
    return tuple(losses)
