"""The three diagrams of a first look at a machine, as Plotly draws them: what the peers of the app show."""

from strikewave import load_case
from strikewave.web.case_state import CaseSource
from strikewave.web.case_values import edited_fields
from strikewave.web.pages.case.machine_view import look


def field(case, path):
    """Return the field that is slid, with the range of its slider."""
    return edited_fields(load_case(case))[path]


def figures(case, path, typed):
    """Return the diagrams of a state as the app computes them, with the same points."""
    made = []
    for options in look(CaseSource(case, "", (f"{path}={typed}",), ""))["charts"]:
        series = options["series"][0]
        if series["type"] == "line":
            x, y = zip(*series["data"], strict=True) if series["data"] else ((), ())
            trace = {"type": "scatter", "mode": "lines", "x": x, "y": y}
        else:
            trace = {"type": "bar", "x": options["xAxis"]["data"], "y": [bar["value"] for bar in series["data"]]}
        titles = {f"{axis}axis": {"title": {"text": options[f"{axis}Axis"]["name"]}} for axis in "xy"}
        made.append({"data": [trace], "layout": {"height": 250, "title": {"text": options["title"]["text"]}, **titles}})
    return made
