# SPDX-License-Identifier: BSD-3-Clause
"""How much more light than the lidar equation says comes back from fog, because droplets send half of it almost straight on: photons followed
through homogeneous fog, against a closed form. Lengths are mean free paths, the view is as wide as the beam.

A droplet diffracts half of what it takes from the beam into a lobe, normal in angle, 1/e at wavelength/(pi radius), and scatters the other half
widely: two terms of Henyey and Greenstein, asymmetry 0.85 of all, and at 180 degrees what S = 18.8 sr says. A path of the small-angle kind turns
back once. What the lobe does on the way back is done on the way out, twice as often (reciprocity, E. W. Eloranta, Applied Optics 37, 1998, and
R. J. Hogan, J. Atmos. Sci. 65, 2008: second-hand). Paths that turn widely twice or more are counted apart, without lobes.

    Testing/Studies/run.py multiple_scattering --out build/weather-multiple
"""
import numpy as np

import avianlidar as al
import tools
from running import study

RATIO = 18.8                     # sr, of fog
FORWARD, BACKWARD = 0.75, -0.8   # asymmetries of the two terms
SENSORS, RADII = ("VLP16", "Search1550", "Search905"), (5e-6, 15e-6)
DEPTHS, HALF = (0.5, 1.0, 2.0), 0.1  # optical depths, and half of a range bin
PHOTONS, SEEDS = 200_000, range(8)
SMALL = 0.1                      # from which share of more light on it matters


def henyey_greenstein(asymmetry, cosine):
    return (1 - asymmetry**2) / (1 + asymmetry**2 - 2 * asymmetry * cosine)**1.5


PART = (8 * np.pi / RATIO - henyey_greenstein(FORWARD, -1)) / (henyey_greenstein(BACKWARD, -1) - henyey_greenstein(FORWARD, -1))


def widely(cosine):
    """The wide half's phase function, 1 on average."""
    return (1 - PART) * henyey_greenstein(FORWARD, cosine) + PART * henyey_greenstein(BACKWARD, cosine)


def turned(directions, angles, random):
    """By these angles, about anything."""
    about = random.uniform(0, 2 * np.pi, len(directions))[:, None]
    across = np.cross(np.where(np.abs(directions[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]]), directions)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    sideways = np.cos(about) * across + np.sin(about) * np.cross(directions, across)
    return np.cos(angles)[:, None] * directions + np.sin(angles)[:, None] * sideways


def followed(half_angle, lobe, photons, seed):
    """Light received from DEPTHS by the number of turns before the last: rows. @param lobe rad; None: paths of wide turns only"""
    random = np.random.default_rng(seed)
    edges = np.ravel([(depth - HALF, depth + HALF) for depth in DEPTHS])
    way = turned(np.tile([0.0, 0.0, 1.0], (photons, 1)), half_angle * np.sqrt(random.uniform(size=photons)), random)
    rate, share = (0.5, 1.0) if lobe is None else (1.5, 1 / 3)  # of the turns, the share of wide ones
    at, length, weight, received = np.zeros((photons, 3)), np.zeros(photons), 1.0, []
    while len(at):
        step = random.exponential(1 / rate, len(at))
        at, length = at + way * step[:, None], length + step
        away = np.linalg.norm(at, axis=1)
        seen = (at[:, 2] > 0) & (np.hypot(at[:, 0], at[:, 1]) <= at[:, 2] * np.tan(half_angle)) if received else True
        back = weight * share * widely(-(way * at).sum(1) / away) / (4 * np.pi) * np.exp(-0.5 * away) / away**2 * seen
        received.append(np.histogram((length + away) / 2, edges, weights=back)[0][::2])
        inside = length < (2 if lobe is None else 1) * edges[-1]
        at, way, length = at[inside], way[inside], length[inside]
        if lobe is None:
            asymmetry = np.where(random.uniform(size=len(at)) < PART, BACKWARD, FORWARD)
            part = (1 - asymmetry**2) / (1 - asymmetry + 2 * asymmetry * random.uniform(size=len(at)))
            angles = np.arccos(np.clip((1 + asymmetry**2 - part**2) / (2 * asymmetry), -1, 1))
        else:
            weight *= 1 - share
            angles = lobe * np.sqrt(-np.log(1 - random.uniform(size=len(at))))
        way = turned(way, angles, random)
    return np.array(received)


def more(half_angle, lobe, photons=PHOTONS, seeds=SEEDS):
    """Received by more than one turn over that by one, at DEPTHS: mean and standard error over the seeds."""
    runs = [followed(half_angle, lobe, photons, seed) for seed in seeds]
    ratios = np.array([run[1:].sum(0) / run[0] for run in runs])
    return ratios.mean(0), ratios.std(0, ddof=1) / np.sqrt(len(ratios))


def share_kept(view_over_lobe):
    """F: the share of what one lobe turns on the way that stays in view, of a narrow beam in fog that begins at the lidar."""
    x = (np.arange(4000) + 0.5) / 4000
    return np.mean(1 - np.exp(-(view_over_lobe / x)**2))


@study()
def main(options):
    rows, wide, errors = [], {}, []
    for name in SENSORS:
        sensor = al.Sensor(name)
        wide[name] = more(sensor.half_beamwidth, None)[0][-1]
        for radius in RADII:
            lobe = 1e-9 * sensor.wavelength / (np.pi * radius)
            found, error = more(sensor.half_beamwidth, lobe)
            errors.append((error / found).max())
            kept = share_kept(sensor.half_beamwidth / lobe)
            rows.append((f"`{name}`, {1e3 * sensor.half_beamwidth:g} mrad", f"{1e6 * radius:g} µm",
                         *(f"{100 * f:.1f} % ({100 * np.expm1(kept * depth):.1f})" for f, depth in zip(found, DEPTHS)),
                         f"{kept:.3f}", f"{np.log1p(SMALL) / kept:.2g}"))
    tools.leave(options.out, "weather-multiple", ("sensor, half-angle", "droplets", *(f"depth {depth:g}" for depth in DEPTHS), "F",
                                                  "10 % from depth"), rows)
    print(f"standard errors up to {100 * max(errors):.1f} % of the numbers")
    print(f"turned widely twice or more, depth {DEPTHS[-1]:g}: " + ", ".join(f"{name} {100 * share:.1f} %" for name, share in wide.items()))
