# SPDX-License-Identifier: BSD-3-Clause
"""A state saved as .pvsm or .py and loaded into an empty session gives the same echoes, to the last bit. A .pvsm state
with properties that are gone loads: they are left out."""

import os

from paraview import simple, smstate

from plugin_testing import OUTPUT_DIR, airport, assert_same, fetch, load_plugin

# Values of every kind that are not the defaults: numbers, vectors, a table, choices, switches, texts.
VALUES = {"beams": {"Position": [0.25, -1.5, 3.125], "Orientation": [10, 0.1, -0.2],
                    "ChannelElevations": [0.1, 0.7, 1.3, 2.9], "HalfBeamwidth": 4e-3, "BeamProfile": "Gaussian",
                    "SamplingInterval": 4e-9}, "echoes": {
              "RaysPerBeam": 17, "BeamSamples": "Rays", "Sampling": "MonteCarlo", "Seed": -5,
              "AttenuationCoefficient": 5e-5, "NumberOfReflections": 1, "BatchCollisionDetection": "Rays",
              "FullModel": 1, "ReturnMode": "Strongest"},
          "tree": {"SplitRule": "Median", "BoundingVolume": "Sphere", "MaximumLeafSize": 7},
          "material": {"Material": "Custom", "Kd": 0.3, "Ks": 0.1, "Kp": 50, "BlockNamePattern": "Terminal*"}}


def build():
    scene, tree, beams, echoes = airport(60)
    material = simple.AvianLidarMaterial(Input=scene)
    tree.Input = material
    colours = simple.AvianLidarHSBColorMap(Input=echoes, UseFieldDataRange=0, EnergyRange=[1e-6, 5e-5])
    for proxy, name in ((beams, "beams"), (echoes, "echoes"), (tree, "tree"), (material, "material"),
                        (colours, "colours")):
        simple.RenameSource(name, proxy)
        for prop, value in VALUES.get(name, {}).items():
            proxy.SetPropertyWithName(prop, value)
    simple.Show(echoes)
    return colours


def check():
    """What is in the session now is what was saved."""
    for name, values in VALUES.items():
        for prop, value in values.items():
            found = simple.FindSource(name).GetPropertyValue(prop)
            assert (list(found) if isinstance(value, list) else found) == value, (name, prop, found, value)


def load(file_name):
    """Into an empty session."""
    simple.ResetSession()
    assert not simple.GetSources()
    load_plugin()
    if file_name.endswith(".pvsm"):
        simple.LoadState(file_name)
    else:
        with open(file_name, encoding="utf-8") as state:
            exec(compile(state.read(), file_name, "exec"), {"__name__": "state"})


def open_again(file_name):
    if file_name.endswith(".pvsm"):
        simple.SaveState(file_name)
    else:
        with open(file_name, "w", encoding="utf-8") as state:
            state.write(smstate.get_state())
    load(file_name)


def main():
    load_plugin()
    expected = fetch(build())
    assert len(expected["energy"]) > 20
    states = [os.path.join(OUTPUT_DIR, "TestState." + extension) for extension in ("py", "pvsm")]
    for file_name in states:
        open_again(file_name)
        check()
        assert_same(fetch(simple.FindSource("colours")), expected)


if __name__ == "__main__":
    main()
