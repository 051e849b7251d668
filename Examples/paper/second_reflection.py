#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the paper's second reflection brings when it is read to the letter. Sec. 2.2 sends reflected light straight towards
"adjacent targets of interest", with the whole f_sur of Eq. 8 in that direction; it says neither how many targets nor with what
weight. The echo filter follows the mirror direction with f_s alone, and with f_d alone the mean over the beam's cone.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 Examples/paper/second_reflection.py

The rays of a beam and what they hit are those of the tracer of Examples/reflections, the same for all readings. A target of a
hit is the hit of another ray of the beam that it faces and sees. Readings:

    here   f_s along the mirror direction, f_d towards targets, mean over the cone: the rules of the echo filter
    mean   f_sur towards targets, mean over the cone
    one    f_sur towards one of the targets, in whole
    all    f_sur towards every target, each in whole

Leaves a table (table.md), and the energies of every beam (beams.csv), as shares of the pulse. Two minutes."""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common"), str(HERE.parent / "corridor"), str(HERE.parent / "reflections")]
import more_reflections as mr  # noqa: E402
import running  # noqa: E402
import tables  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402

READINGS = ("here", "mean", "one", "all")


class Beam(mr.Beam):
    """Adds `second`: what comes back over two reflections in each reading, as a share of the pulse, and `beyond`: how many rays
    return more than they reflect in each."""

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
    half, pulse, limit = (chosen.GetFieldData().GetArray(name).GetValue(0)
                          for name in ("half_beamwidth", "pulse_energy", "lower_energy_limit"))
    surfaces = mr.Surfaces(subject.tree.GetOutput())
    places = zip(vtk_to_numpy(chosen.GetPoints().GetData()).astype(float),
                 vtk_to_numpy(chosen.GetPointData().GetArray("direction")).astype(float))
    return [Beam(surfaces, origin, axis, half, mr.rays_of(axis, half, rays, random), subject.attenuation, random)
            for origin, axis in places], limit / pulse


def columns(beams, limit, reading):
    """(column, text): the beams in one reading, and beside the first."""
    direct = np.array([beam.throughput[0] for beam in beams])
    here, second = (np.array([beam.second[name] for beam in beams]) for name in (READINGS[0], reading))
    before, now = direct + here > limit, direct + second > limit
    change = 100 * abs(second - here)[before] / (direct + here)[before]
    return [("2 (% of Qs)", mr.percent(*mr.Measured.mean(second))),
            ("2, % of all received", f"{100 * second.sum() / (direct + second).sum():.2f}"),
            ("beams above Qlow", f"{now.sum()} of {len(beams)}"), ("gained", (now & ~before).sum()), ("lost", (before & ~now).sum()),
            ("of those above: changed by 1 %", (change > 1).sum()),
            ("most change (%)", f"{change.max(initial=0):.1f}"),
            ("rays that return more than kd + ks", sum(beam.beyond[reading] for beam in beams))]


def table(results):
    """Markdown: a row for each scene and reading."""
    made = {}
    for scene, (beams, limit) in results.items():
        for reading in READINGS:
            for label, text in columns(beams, limit, reading):
                made.setdefault(label, []).append((f"{scene}: {reading}", text))
    return tables.table(made)


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--beams", type=running.whole(2, 1000000), default=2000,
                        help="of the corridor, default 2000; four times as many of the airport")
    parser.add_argument("--rays", type=running.whole(2, 100000), default=30, help="rays per beam, default 30")
    parser.add_argument("--seed", type=running.whole(0, 2**31 - 1), default=0, help="of the random numbers, default 0")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/paper/second-reflection"),
                        help="folder for results")
    return parser.parse_args(argv)


def main(argv=None):
    options = arguments(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    results = {}
    lines = ["scene,beam,over one,Qlow," + ",".join(f"over two: {reading}" for reading in READINGS)]
    for count, make in ((options.beams, mr.corridor),
                        (4 * options.beams, lambda: mr.outdoors("Hongqiao, 16 channels", mr.HONGQIAO, "Airport16"))):
        subject = make()
        beams, limit = results[subject.name] = measure(subject, count, options.rays, options.seed)
        for number, beam in enumerate(beams):
            values = (beam.throughput[0], limit, *beam.second.values())
            lines.append(f'"{subject.name}",{number},' + ",".join(f"{value:.6g}" for value in values))
    text = table(results)
    tables.write(options.out, "table", text)
    (options.out / "beams.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(text)
    return results


if __name__ == "__main__":
    main()
