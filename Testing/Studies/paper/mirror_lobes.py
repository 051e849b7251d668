# SPDX-License-Identifier: BSD-3-Clause
"""Light between a mirror of finite lobe and a matt wall, through an aperture, against sums of its own (NumPy): rays of the
beam, one direction from the lobe cos^kp of each mirror that they meet, and what the lidar sees where it ends. From there
directions go to the places of the mirror that show the end. Directions below the horizon of the mirror are lost. Leaves a
table. Half a minute.

    Testing/Studies/run.py mirror_lobes
"""
import math

import numpy as np

import avianlidar as al
import tools
from running import argument, study, whole

APERTURE, PULSE, HALF = 0.00785, 3.6e-4, 5.6e-3  # m2, J, rad
HEIGHT, PLACES = 3.0, 4  # of the lidar above water, m; places of the mirror for each end
WATER, ROUGH, GLASS = (0.0, 0.3, 8046.0), (0.02, 0.6, 500.0), (0.02, 0.852, 8046.0)  # kd, ks, kp


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def dot(a, b):
    return (a * b).sum(axis=-1)


def about(axes, cosines, random):
    """Directions at angles from axes."""
    other = np.where(abs(axes[:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = unit(np.cross(axes, other))
    turn, sines = 2 * np.pi * random.random(len(axes)), np.sqrt(1 - cosines ** 2)
    across = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * np.cross(axes, first)
    return cosines[:, None] * axes + sines[:, None] * across


class Corner:
    """A mirror (number 0) and a wall (1). @param plates middle and two half sides of both @param materials of both"""

    def __init__(self, plates, materials, axis):
        self.plates, self.materials = np.array(plates, dtype=float), materials
        self.normals = unit(np.cross(self.plates[:, 1], self.plates[:, 2]))
        self.normals *= np.sign(dot(self.normals, -self.plates[:, 0]))[:, None]  # towards the lidar
        self.axis = unit(np.array(axis, dtype=float))

    def first(self, starts, ways):
        """Distance of the first plate and its number, -1 if there is none."""
        nearest, which = np.full(len(ways), np.inf), np.full(len(ways), -1)
        for number, ((middle, u, v), normal) in enumerate(zip(self.plates, self.normals)):
            with np.errstate(divide="ignore", invalid="ignore"):
                t = ((middle - starts) @ normal) / (ways @ normal)
                p = starts + t[:, None] * ways - middle
                met = (t > 1e-7) & (t < nearest) & (abs(p @ u) <= u @ u) & (abs(p @ v) <= v @ v)
            nearest[met], which[met] = t[met], number
        return nearest, which

    def rays(self, count, random):
        """Rays evenly over the cone, and what they meet."""
        cosines = 1 - random.random(count) * (1 - math.cos(HALF))
        ways = about(np.tile(self.axis, (count, 1)), cosines, random)
        return (ways, *self.first(np.zeros((count, 3)), ways))

    def energies(self, count, random):
        """J after one reflection, after two over mirror and wall (both ways), and after three by the mirror."""
        ways, ranges, met = self.rays(count, random)
        one = 0.0
        for number, (kd, _, _) in enumerate(self.materials):
            of = met == number
            one += kd * (-(ways[of] @ self.normals[number]) / ranges[of] ** 2).sum()
        mirror, wall = self.normals
        (_, rho, kp), white = self.materials[0], self.materials[1][0]
        starts, cosines = (ways * ranges[:, None])[met == 0], -(ways[met == 0] @ mirror)
        mirrored = ways[met == 0] + 2 * cosines[:, None] * mirror
        out = about(mirrored, random.random(len(mirrored)) ** (1 / (kp + 1)), random)
        step, end = self.first(starts, out)
        arrives = (end == 1) & (out @ mirror > 0)
        points, rise = (starts + step[:, None] * out)[arrives], (out @ mirror / cosines)[arrives]
        away = np.linalg.norm(points, axis=1)
        seen = self.first(np.zeros_like(points), points / away[:, None])[0] > (1 - 1e-9) * away
        seen &= points @ self.axis >= math.cos(HALF) * away
        there = rho * white * seen * -(points @ wall) / away ** 3
        # From the end to the mirror, about the way to the place that shows the end in an exact mirror.
        heights = (points - self.plates[0, 0]) @ mirror
        images = points - 2 * heights[:, None] * mirror
        exact = images * (self.plates[0, 0] @ mirror / (images @ mirror))[:, None]
        again = np.zeros(len(points))
        for _ in range(PLACES):
            cosine = random.random(len(points)) ** (1 / (kp + 1))
            back = about(unit(exact - points), cosine, random)
            length, plate = self.first(points, back)
            good = plate == 0
            place = points + np.where(good, length, 0)[:, None] * back
            ranges = np.linalg.norm(place, axis=1)
            sight = place / ranges[:, None]
            good &= sight @ self.axis >= math.cos(HALF)
            shown = sight - 2 * (sight @ mirror)[:, None] * mirror
            density = (np.maximum(-dot(shown, back), 0) / cosine) ** kp
            again += good * density * np.maximum(back @ wall, 0) / ranges ** 2
        again *= rho ** 2 * white / PLACES
        scale = PULSE * APERTURE / (np.pi * count)
        return scale * np.array([one, (there * (1 + rise)).sum(), again.sum()])

    def simulated(self, reflections, seeds):
        """Received energy and its stated error by seed, J."""
        corners = [middle + a * u + b * v for middle, u, v in self.plates for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        scene = al.Scene((np.array(corners), np.array([(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)])),
                         material=[self.materials[k // 2] for k in range(4)])
        sensor = al.Sensor("Airport16", directions=[self.axis], lower_energy_limit=0, upper_energy_limit=1,
                           receiver_aperture=APERTURE, half_beamwidth=HALF, pulse_energy=PULSE, sampling_interval=1e-5,
                           pulse_width=0)
        found = []
        for seed in range(seeds):
            echoes = al.Scan(scene, sensor, number_of_reflections=reflections, noise=False, attenuation_coefficient=0,
                             seed=seed).echoes
            found.append((echoes["energy_received"].sum(), np.hypot.reduce(echoes["energy_std_error"])))
        return np.array(found)


def shore(degrees, mirror):
    """Level water before a facade that the axis meets at its foot."""
    angle = math.radians(degrees)
    away = HEIGHT / math.tan(angle)
    return Corner([[(0, away / 2, -HEIGHT), (50, 0, 0), (0, away / 2, 0)], [(0, away, 10 - HEIGHT), (50, 0, 0), (0, 0, 10)]],
                  (mirror, (0.3, 0.0, 1.0)), (0, math.cos(angle), -math.sin(angle)))


def upright(degrees):
    """A pane and a wall that meet at an angle, 100 m away."""
    half = math.radians(degrees / 2)
    sides = [5 * np.array((sign * math.sin(half), -math.cos(half), 0)) for sign in (-1, 1)]
    return Corner([[np.array((0, 100, 0)) + side, side, (0, 0, 10)] for side in sides], (GLASS, (0.5, 0.0, 1.0)), (0, 1, 0))


@study(argument("--rays", type=whole(1000, 10**7), default=200000, help="of a sum, default 200000"),
       argument("--seeds", type=whole(2, 10000), default=100, help="scans of a scene, default 100"))
def main(options):
    scenes = {f"water, kp {mirror[2]:g}, met at {degrees}°": shore(degrees, mirror)
              for mirror in (WATER, ROUGH) for degrees in (2.86, 1, 0.5)}
    scenes.update({f"pane and wall at {degrees}°": upright(degrees) for degrees in (60, 90, 120)})
    rows = []
    for name, corner in scenes.items():
        sums = np.array([corner.energies(options.rays, np.random.default_rng(k)) for k in range(8)])
        row = [name]
        for order in (2, 3):
            own = sums[:, :order].sum(axis=1)
            found = corner.simulated(order, options.seeds)
            off = 100 * (found[:, 0].mean() / own.mean() - 1)
            error = 100 * math.hypot(found[:, 0].std() / options.seeds ** 0.5, own.std() / 8 ** 0.5) / own.mean()
            row += [f"{own.mean():.3e}", f"{off:+.1f} ± {error:.1f}"]
        rows.append([*row, f"{100 * np.median(found[:, 1] / found[:, 0]):.1f}"])
    tools.leave(options.out, "mirror-lobes", ("scene", "up to two reflections, J", "simulated, %", "up to three, J", "simulated, %",
                                              "stated standard error of a scan, %"), rows)
    return rows
