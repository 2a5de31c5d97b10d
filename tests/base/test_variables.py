"""Arrays with names and units beside xarray."""

import numpy as np
import pytest
import xarray

from strikewave import load_case, run_case
from strikewave.base.datasets import LabelledArrays, quantity


@pytest.fixture(scope="module", params=["li-ma-2019", "li-ma-2019-fig13"])
def arrays(request):
    """What a run keeps: texts, whole numbers, coordinates among the variables, of a stack also fields and readings."""
    return run_case(load_case(request.param, ["feed.blows=1"])).arrays


@pytest.mark.verify
def test_file_is_that_of_xarray(arrays, tmp_path):
    arrays.write(tmp_path / "ours.nc")
    arrays.to_xarray().to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "ours.nc") as ours, xarray.open_dataset(tmp_path / "theirs.nc") as theirs:
        xarray.testing.assert_identical(ours, theirs)
        for name, variable in theirs.variables.items():
            assert ours[name].dtype == variable.dtype
            assert ours[name].encoding.keys() == variable.encoding.keys()


def test_to_xarray_and_back(arrays):
    data = arrays.to_xarray()
    again = LabelledArrays.of_xarray(data)
    assert list(again.data_vars) == list(arrays.data_vars) == list(data.data_vars)
    assert set(again.coords) == set(arrays.coords) == set(data.coords)
    assert again.sizes == arrays.sizes == dict(data.sizes)
    assert again.attrs == arrays.attrs
    xarray.testing.assert_identical(again.to_xarray(), data)


def test_a_variable_named_as_its_dimension_is_a_coordinate():
    arrays = LabelledArrays.of({"t": quantity("t", np.arange(3.0), "s", "time"), "v": ("t", [1, 2, 3])}, {}, {"a": 1})
    assert list(arrays.coords) == ["t"]
    xarray.testing.assert_identical(
        arrays.to_xarray(), xarray.Dataset({"v": ("t", [1, 2, 3])}, arrays.coords, {"a": 1})
    )


def test_one_value_and_no_value_are_written(tmp_path):
    arrays = LabelledArrays.of({"none": ("x", np.empty(0)), "text": ("y", np.array(["a"], dtype=object))}, {}, {"n": 2})
    arrays.write(tmp_path / "few.nc")
    with xarray.open_dataset(tmp_path / "few.nc", engine="h5netcdf") as read:
        xarray.testing.assert_identical(read.load(), arrays.to_xarray())
