# SPDX-License-Identifier: BSD-3-Clause
"""What the paper's second reflection brings when it is read to the letter. Sec. 2.2 sends reflected light straight
towards "adjacent targets of interest", with the whole f_sur of Eq. 8 in that direction; it says neither how many
targets nor with what weight. The echo filter follows the mirror direction with f_s alone, and with f_d alone the mean
over the beam's cone.

    Testing/Studies/run.py second_reflection

The rays of a beam and what they hit are those of the tracer of more_reflections.py, the same for all readings. A target
of a hit is the hit of another ray of the beam that it faces and sees. Readings:

    here   f_s along the mirror direction, f_d towards targets, mean over the cone: the rules of the echo filter
    mean   f_sur towards targets, mean over the cone
    one    f_sur towards one of the targets, in whole
    all    f_sur towards every target, each in whole

Leaves a table. Two minutes."""
import numpy as np

import more_reflections as mr
import tools
from running import argument, study, whole

READINGS = ("here", "mean", "one", "all")


class Beam(mr.Beam):
    """Adds `second`: what comes back after two reflections in each reading, as a share of the pulse, and `beyond`: how
    many rays return more than they reflect in each."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.second = dict.fromkeys(READINGS, 0.0)
        self.second["here"] = self.throughput[1]
        self.beyond = dict.fromkeys(READINGS, 0)
        hits = [(ray, point, cell) for ray, (point, cell) in zip(self.rays, self.hits) if point is not None]
        if len({cell for _, _, cell in hits}) < 2:
            return
        self.directions = np.array([ray for ray, _, _ in hits])
        self.points = np.array([point for _, point, _ in hits])
        self.cells = [cell for _, _, cell in hits]
        normals = self.surfaces.normals[self.cells]
        self.normals = np.where(((normals * self.directions).sum(axis=1) > 0)[:, None], -normals, normals)
        self.ranges = np.linalg.norm(self.points - self.origin, axis=1)
        for one in range(len(hits)):
            self._literal(one)

    def _literal(self, one):
        """All light from a hit to its targets and back, per joule that arrives there."""
        ways = self.points - self.points[one]
        lengths = np.linalg.norm(ways, axis=1)
        facing = (ways @ self.normals[one] > 1e-9 * lengths) & ((ways * self.normals).sum(axis=1) < -1e-9 * lengths)
        values = [self._path(one, two, ways[two] / lengths[two], lengths[two])
                  for two in np.flatnonzero(facing) if self._in_sight(one, two, ways[two] / lengths[two], lengths[two])]
        if not values:
            return
        back, material = -self.directions[one], self.surfaces.material(self.cells[one])
        direct = mr.sur(material, back @ self.normals[one], -back, back, self.normals[one])
        whole = np.sum(values, axis=0)  # with the air, without it
        for name, share in (("mean", 1 / (len(self.rays) - 1)), ("one", 1 / len(values)), ("all", 1.0)):
            self.second[name] += share * whole[0] / len(self.rays)
            self.beyond[name] += direct + share * whole[1] > material[0] + material[1]

    def _in_sight(self, one, two, way, length):
        met, which = self.surfaces.first(self.points[one], way, self.cells[one], length)
        return which in (-1, self.cells[two]) or np.linalg.norm(met - self.points[one]) >= (1 - 1e-9) * length

    def _path(self, one, two, way, length):
        """f_sur at both ends: with the air, and without."""
        first = mr.sur(self.surfaces.material(self.cells[one]), -(self.directions[one] @ self.normals[one]),
                       self.directions[one], way, self.normals[one])
        second = mr.sur(self.surfaces.material(self.cells[two]), -(way @ self.normals[two]), way, -self.directions[two],
                        self.normals[two])
        air = np.exp(-self.attenuation * (self.ranges[one] + length + self.ranges[two]))
        return first * second * air, first * second


def measure(subject, count, rays, seed=0):
    """Beams of a subject of more_reflections.py, and Qlow over Qs."""
    random = np.random.default_rng(seed)
    chosen = mr.chosen_beams(subject, count, random)
    half, pulse, limit = mr.fields_of(chosen)
    surfaces = mr.Surfaces(subject.tree.GetOutput())
    return [Beam(surfaces, origin, axis, half, mr.rays_of(axis, half, rays, random), subject.attenuation, random)
            for origin, axis in zip(*mr.places_of(chosen))], limit / pulse


def columns(beams, limit, reading):
    """(column, text): the beams in one reading, and beside the first."""
    direct = np.array([beam.throughput[0] for beam in beams])
    here, second = (np.array([beam.second[name] for beam in beams]) for name in (READINGS[0], reading))
    before, now = direct + here > limit, direct + second > limit
    change = 100 * abs(second - here)[before] / (direct + here)[before]
    return [("2 (% of Qs)", mr.percent(*mr.Measured.mean(second))),
            ("2, % of all received", f"{100 * second.sum() / (direct + second).sum():.2f}"),
            ("beams above Qlow", f"{now.sum()} of {len(beams)}"), ("gained", (now & ~before).sum()),
            ("lost", (before & ~now).sum()), ("of those above: changed by 1 %", (change > 1).sum()),
            ("most change (%)", f"{change.max(initial=0):.1f}"),
            ("rays that return more than kd + ks", sum(beam.beyond[reading] for beam in beams))]


@study(argument("--beams", type=whole(2, 1000000), default=2000,
                help="of the corridor, default 2000; four times as many of the airport"),
       argument("--rays", type=whole(2, 100000), default=30, help="rays per beam, default 30"),
       argument("--seed", type=whole(0, 2**31 - 1), default=0, help="of the random numbers, default 0"))
def main(options):
    rows = []
    airport = mr.outdoors("Hongqiao, 16 channels", "airport", "Airport16")
    for count, subject in ((options.beams, mr.corridor()), (4 * options.beams, airport)):
        beams, limit = measure(subject, count, options.rays, options.seed)
        rows += [{"": f"{subject.name}: {reading}", **dict(columns(beams, limit, reading))} for reading in READINGS]
    tools.leave(options.out, "second-reflection", list(rows[0]), [list(row.values()) for row in rows])
    return rows
