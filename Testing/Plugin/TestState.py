# SPDX-License-Identifier: BSD-3-Clause
"""A state saved as .pvsm or .py and loaded into an empty session gives the same echoes, to the last bit. A .pvsm state with
properties that are gone loads: they are left out."""

import os

from paraview import simple, smstate

from plugin_testing import OUTPUT_DIR, airport, assert_same, fetch, load_plugin

# Values of every kind that are not the defaults: numbers, vectors, a table, choices, switches, texts.
BEAMS = {
    "Position": [0.25, -1.5, 3.125],
    "Orientation": [10, 0.1, -0.2],
    "ChannelElevations": [0.1, 0.7, 1.3, 2.9],
    "HalfBeamwidth": 4e-3,
    "BeamProfile": "Gaussian",
    "SamplingInterval": 4e-9,
}
ECHOES = {
    "RaysPerBeam": 37,
    "BeamSamples": "Rays",
    "Sampling": "MonteCarlo",
    "Seed": -5,
    "AttenuationCoefficient": 5e-5,
    "NumberOfReflections": 1,
    "BatchCollisionDetection": "Rays",
    "FullModel": 1,
    "ReturnMode": "Strongest",
}
TREE = {"SplitRule": "Median", "BoundingVolume": "Sphere", "MaximumLeafSize": 7}
MATERIAL = {"Material": "Custom", "Kd": 0.3, "Ks": 0.1, "Kp": 50, "BlockNamePattern": "Terminal*"}


def build():
    scene, tree, beams, echoes = airport(240)
    material = simple.AvianLidarMaterial(registrationName="material", Input=scene)
    tree.Input = material
    colours = simple.AvianLidarHSBColorMap(
        registrationName="colours", Input=echoes, UseFieldDataRange=0, EnergyRange=[1e-6, 5e-5]
    )
    for proxy, values in ((beams, BEAMS), (echoes, ECHOES), (tree, TREE), (material, MATERIAL)):
        for name, value in values.items():
            proxy.SetPropertyWithName(name, value)
    simple.RenameSource("tree", tree)
    simple.RenameSource("beams", beams)
    simple.RenameSource("echoes", echoes)
    simple.Show(echoes)
    return colours


def save(file_name):
    if file_name.endswith(".py"):
        with open(file_name, "w", encoding="utf-8") as state:
            state.write(smstate.get_state())
    else:
        simple.SaveState(file_name)


def check(echoes=ECHOES):
    """What is in the session now is what was saved."""
    for name, values in (("beams", BEAMS), ("echoes", echoes), ("tree", TREE), ("material", MATERIAL)):
        proxy = simple.FindSource(name)
        for prop, value in values.items():
            found = proxy.GetPropertyValue(prop)
            found = list(found) if isinstance(value, list) else found
            assert found == value, (name, prop, found, value)


def open_again(file_name):
    """An empty session, then the state."""
    save(file_name)
    simple.ResetSession()
    assert not simple.GetSources()
    load_plugin()
    if file_name.endswith(".pvsm"):
        simple.LoadState(file_name)
    else:
        with open(file_name, encoding="utf-8") as state:
            exec(compile(state.read(), file_name, "exec"), {"__name__": "state"})


def check_sensors(file_name):
    """Lidars of makers come back with what no property has: offsets and times of channels, prisms."""
    for name in ("AvianLidarOS164", "AvianLidarMid40"):
        simple.ResetSession()
        load_plugin()
        lidar = getattr(simple, name)(registrationName="lidar", PulseEnergy=5e-7)
        simple.Show(lidar)
        expected = fetch(lidar)
        open_again(file_name)
        assert simple.FindSource("lidar").PulseEnergy == 5e-7
        assert_same(fetch(simple.FindSource("lidar")), expected)


def main():
    load_plugin()
    expected = fetch(build())
    assert len(expected["energy"]) > 100
    for extension in ("py", "pvsm"):
        file_name = os.path.join(OUTPUT_DIR, "TestState." + extension)
        open_again(file_name)
        check()
        assert_same(fetch(simple.FindSource("colours")), expected)
    with open(file_name, encoding="utf-8") as state:
        old = state.read().replace('name="BeamSamples"', 'name="PlaneIntegration"')
    assert old.count('name="PlaneIntegration"') > 0
    with open(file_name, "w", encoding="utf-8") as state:
        state.write(old)
    simple.ResetSession()
    load_plugin()
    simple.LoadState(file_name)
    check({**ECHOES, "BeamSamples": "Cells"})
    for extension in ("py", "pvsm"):
        check_sensors(os.path.join(OUTPUT_DIR, "TestState_sensor." + extension))


if __name__ == "__main__":
    main()
