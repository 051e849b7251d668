# SPDX-License-Identifier: BSD-3-Clause
"""ParaView macro: colours the active echoes by energy as the paper does, blue at Qlow and red at Qhigh.

The range is the receiver's, from the field data that travel with the echoes, and stays: rescaled to the data, a
colour would no longer mean one energy. Without limits in the field data, the array `energy` or the preset,
nothing is changed and the reason is printed.

In ParaView: the button is there with the plugin; select the echoes and click it. In a script: colour(source, view).
"""

from paraview import servermanager, simple

PRESET = "Avian lidar HSB"
ARRAY = "energy"
LIMITS = ("lower_energy_limit", "upper_energy_limit")


def energy_limits(source):
    """(Qlow, Qhigh) in joules from the field data of the output."""
    field_data = source.GetFieldDataInformation()
    limits = []
    for name in LIMITS:
        array = field_data.GetArray(name)
        if array is None:
            raise ValueError(f"the field data have no {name}: are these echoes of an avian lidar?")
        limits.append(array.GetRange(0)[0])
    return tuple(limits)


def colour(source, view=None):
    """Colours an output by energy with the preset over the receiver's limits; returns (Qlow, Qhigh)."""
    if source.GetPointDataInformation().GetArray(ARRAY) is None:
        raise ValueError(f"there is no point array {ARRAY}")
    low, high = energy_limits(source)
    if not servermanager.vtkSMTransferFunctionPresets.GetInstance().HasPreset(PRESET):
        raise ValueError(f"there is no colour preset {PRESET}: load the plugin, or import AvianLidarHSB.json")
    view = view or simple.GetActiveViewOrCreate("RenderView")
    display = simple.Show(source, view)
    simple.ColorBy(display, ("POINTS", ARRAY))
    table = simple.GetColorTransferFunction(ARRAY)
    # First: setting the range would otherwise be undone by the next update.
    table.AutomaticRescaleRangeMode = "Never"
    table.ApplyPreset(PRESET, True)
    table.RescaleTransferFunction(low, high)
    simple.GetOpacityTransferFunction(ARRAY).RescaleTransferFunction(low, high)
    bar = simple.GetScalarBar(table, view)
    bar.Title = "energy (J)"
    bar.ComponentTitle = ""
    display.SetScalarBarVisibility(view, True)
    return low, high


def main():
    source = simple.GetActiveSource()
    if source is None:
        print("Avian lidar colours: select the echoes first.")
        return
    try:
        colour(source)
    except ValueError as problem:
        print(f"Avian lidar colours: {problem}.")
        return
    simple.Render()


if __name__ in ("__main__", "__vtkconsole__"):
    main()
