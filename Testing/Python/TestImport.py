# SPDX-License-Identifier: BSD-3-Clause
"""The package is found by its names, and its classes are VTK algorithms: they know what they are, print every property,
and are modified by a new value of one and not by the same value again."""

import avianlidar
from avianlidar import vtkAvianLidar
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

assert avianlidar.__version__
assert "vtkAvianLidar" in avianlidar.__all__
assert all(hasattr(avianlidar, name) for name in avianlidar.__all__)


def own_names(cls):
    return {name for base in cls.__mro__ if base.__name__.startswith("vtkAvianLidar") for name in vars(base)}


def properties(one):
    """Name and value of each property that can be read without an argument."""
    for name in sorted(own_names(type(one))):
        if name.startswith("Set") and hasattr(one, "Get" + name[3:]):
            try:
                yield name[3:], getattr(one, "Get" + name[3:])()
            except TypeError:
                pass  # by index


seen = 0
for cls in vars(vtkAvianLidar).values():
    if not (isinstance(cls, type) and issubclass(cls, vtkAlgorithm)) or cls.__name__ in (
            "vtkAvianLidarCloudWriter", "vtkAvianLidarScanFilter"):
        continue
    one = cls()
    assert one.IsA(cls.__name__) and one.IsA("vtkAlgorithm") and not one.IsA("vtkPolyData"), cls
    assert cls.SafeDownCast(one) is one and cls.IsTypeOf(cls.__name__) and not cls.IsTypeOf("vtkPolyData"), cls
    assert isinstance(one.NewInstance(), cls), cls
    text = str(one)
    for name, value in properties(one):
        seen += 1
        assert f"{name}: " in text, (cls.__name__, name)
        put = getattr(one, "Set" + name)
        before = one.GetMTime()
        put(*value) if isinstance(value, tuple) else put(value)
        assert one.GetMTime() == before, (cls.__name__, name, value)
        if isinstance(value, bool):
            put(not value)
            assert one.GetMTime() > before and getattr(one, "Get" + name)() is not value, (cls.__name__, name)
            if hasattr(one, name + "On"):
                getattr(one, name + "On")()
                assert getattr(one, "Get" + name)() is True
                getattr(one, name + "Off")()
                assert getattr(one, "Get" + name)() is False
        if name.endswith("FileName") or isinstance(value, str):
            put("a b")
            assert getattr(one, "Get" + name)() == "a b" and "a b" in str(one), (cls.__name__, name)
assert seen > 200, seen
