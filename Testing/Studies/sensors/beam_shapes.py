# SPDX-License-Identifier: BSD-3-Clause
"""Beams that are not round, as a small plate sees them that is moved through each: the energy that comes back, place by place.

    Testing/Studies/run.py beam_shapes --out build/shapes
"""
import numpy as np

import avianlidar as al
import tools
from running import study

AWAY = 100.0    # m
PLATE = 0.02    # m, its side
REACH = 0.8     # m, to each side
PLACES = 81     # along a side
SHAPES = (
    ("round, uniform", {"half_beamwidth": 5.6e-3}),
    ("round, Gaussian", {"half_beamwidth": 5.6e-3, "beam_profile": "Gaussian"}),
    ("Gaussian, cut at 2 radii of 1/e²", {"half_beamwidth": 5.6e-3, "beam_profile": "Gaussian", "gaussian_truncation": 2}),
    ("ellipse, turned by 30°", {"half_beamwidth": 6e-3, "half_beamwidth_across": 2e-3, "beam_rotation": 30}),
    ("rectangle, turned by 30°", {"half_beamwidth": 6e-3, "half_beamwidth_across": 2e-3, "beam_rotation": 30, "beam_outline": "Rectangle"}),
    ("rectangle, Gaussian", {"half_beamwidth": 6e-3, "half_beamwidth_across": 3e-3, "beam_outline": "Rectangle", "beam_profile": "Gaussian"}),
    ("square", {"half_beamwidth": 4e-3, "beam_outline": "Rectangle"}),
    ("Avia", {}),
)


def light_of(name, shape):
    """Energy from a plate at each place, over the largest: PLACES x PLACES, from below left."""
    offsets = np.linspace(-REACH, REACH, PLACES)
    x, z = (grid.ravel() for grid in np.meshgrid(offsets, offsets))
    # The plate stands still and each beam looks past it.
    directions = np.column_stack([-x, np.full(x.size, AWAY), -z])
    half = PLATE / 2
    plate = al.Scene([(-half, AWAY, -half), (half, AWAY, -half), (half, AWAY, half), (-half, AWAY, half)], [(0, 1, 2), (0, 2, 3)],
                     material=(1, 0, 1))
    sensor = al.Sensor(name if not shape else "Airport16", directions=directions, rotation_rate=0.01, receiver_model="EnergyLimits",
                       lower_energy_limit=0, upper_energy_limit=1, **shape)
    echoes = al.Scan(plate, sensor, noise=False, number_of_reflections=1).echoes
    light = np.zeros(x.size)
    np.add.at(light, echoes["beam_id"], echoes["energy_received"])
    return light.reshape(PLACES, PLACES) / light.max()


@study()
def main(options):
    reach = 1e3 * REACH / AWAY
    with tools.figure(options.out / "shapes.png", 2, 4, figsize=(11.0, 5.6), dpi=80) as panels:
        for (name, shape), axes in zip(SHAPES, panels.flat):
            image = axes.imshow(light_of(name, shape), origin="lower", extent=(-reach, reach, -reach, reach), cmap="magma", vmin=0, vmax=1)
            axes.set_title(name, fontsize=9)
            axes.tick_params(labelsize=8)
        axes.figure.colorbar(image, ax=list(panels.flat), label="energy, over the largest")
        axes.figure.supxlabel("to the right, mrad", fontsize=9)
        axes.figure.supylabel("up, mrad", fontsize=9)
