# SPDX-License-Identifier: BSD-3-Clause
"""How much light comes back after three reflections and more, which the echo filter leaves out? A ray tracer of its own
(NumPy, and VTK's cell locator in place of the collision tree) follows paths over up to eight reflections, in scenes
made of mirrors, in the corridor and at the airport. Its first two orders are compared with the echo filter. Leaves
tables.

    Testing/Studies/run.py more_reflections

A path O, P1, ..., Pm, O follows the rules that Documentation/method/echoes.md has for two reflections. From each hit
but the last it goes on in the mirror direction, with f_s = ks, or, at most twice, to the hit point of another ray of
the beam, with f_d = kd cos(theta_i). At the last hit the whole f_sur towards O acts; it counts only if Pm lies in the
beam's cone, is visible from O, and is met on the side that faces O. Between mirrors a path may leave the cone. Diffuse
light from outside the cone is left out: as a form factor, some (theta_0.5 r/L)^2 of it meets what the beam lights, 3e-5
from as far as O is.
"""
import dataclasses
import math

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet, vtkStaticCellLocator

import running
import tools
import trade_runs
from running import argument, built_scene, column, study, whole
from trade_runs import Subject

ORDERS = 8
LEAST = 1e-7  # of a ray's energy: what carries less is not followed
CONNECTIONS = 2  # diffuse reflections of a path before its last: all there can be in order three
RANGE = 100.0  # m, from the lidar to the scenes of mirrors


# --- the tracer

class Surfaces:
    """Triangles with kd, ks, kp, and the nearest of them along a ray."""

    def __init__(self, data):
        corners = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
        cells = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        a, b, c = (corners[cells[:, i]] for i in range(3))
        across = np.cross(b - a, c - a)
        self.normals = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
        self.materials = [vtk_to_numpy(data.GetCellData().GetArray(name)).tolist() for name in ("kd", "ks", "kp")]
        self.most = max(kd + ks for kd, ks in zip(*self.materials[:2]))
        self.reach = 2 * np.linalg.norm(np.ptp(corners, axis=0))
        self.middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        self.locator = vtkStaticCellLocator()
        self.locator.SetDataSet(data)
        self.locator.BuildLocator()
        self._found = mutable(0.0), [0.0] * 3, [0.0] * 3, mutable(0), mutable(0)

    def material(self, cell):
        return tuple(values[cell] for values in self.materials)

    def first(self, start, direction, left=-1, reach=None):
        """Where a ray first meets a triangle other than the one that it leaves: (point, cell), or (None, -1)."""
        reach = reach or self.reach + np.linalg.norm(start - self.middle)
        t, point, inside, part, cell = self._found
        begin = start
        for _ in range(4):
            # Without a tolerance VTK loses some rays that start or end on its boxes.
            if not self.locator.IntersectWithLine(begin, start + reach * direction, 1e-9, t, point, inside, part, cell):
                return None, -1
            if int(cell) != left:
                return np.array(point), int(cell)
            begin = np.array(point) + 1e-9 * reach * direction
        return None, -1


def sur(material, cosine, incident, outgoing, normal):
    """f_sur, paper's Eq. 5 to 8."""
    kd, ks, kp = material
    mirror = incident - 2 * (incident @ normal) * normal
    lobe = mirror @ outgoing
    square = np.cross(mirror, outgoing) @ np.cross(mirror, outgoing)
    # Near the peak the sine has the digits.
    power = 0.0 if lobe <= 0 else math.exp(0.5 * kp * (math.log1p(-square) if lobe > 0.7 else 2 * math.log(lobe)))
    return kd * cosine + ks * power


def rays_of(axis, half, count, random):
    """Unit vectors, uniform in solid angle within `half` radians of the axis."""
    away = random.random(count) * 2 * math.sin(0.5 * half) ** 2  # 1 - cosine
    turn = random.random(count) * 2 * math.pi
    sine = np.sqrt(away * (2 - away))
    one = np.cross(axis, np.eye(3)[np.argmin(abs(axis))])
    one /= np.linalg.norm(one)
    other = np.cross(axis, one)
    rays = (sine * np.cos(turn))[:, None] * one + (sine * np.sin(turn))[:, None] * other + (1 - away)[:, None] * axis
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


class Beam:
    """All paths of one beam: `throughput[m - 1]` is what comes back over m reflections, as a share of the pulse."""

    def __init__(self, surfaces, origin, axis, half, rays, attenuation, random, connections=CONNECTIONS):
        self.surfaces, self.origin, self.axis, self.attenuation = surfaces, origin, axis, attenuation
        self.cos_half = math.cos(half)
        self.rays = rays
        self.hits = [surfaces.first(origin, ray) for ray in rays]
        self.connections = min(connections, len(rays) - 1)
        self.shifts = random.choice(np.arange(1, max(len(rays), 2)), self.connections, replace=False)
        self.throughput = np.zeros(ORDERS)
        self.under_way = 0.0  # leaves the last order that is followed
        for number, (point, cell) in enumerate(self.hits):
            if point is not None:
                self.number = number
                length = np.linalg.norm(point - origin)
                self._reflect(1, point, cell, rays[number], length, 1.0 / len(rays), 0, True)

    def _is_seen(self, point, cell):
        """Whether O sees a point in the cone."""
        way = point - self.origin
        far = np.linalg.norm(way)
        if way @ self.axis < self.cos_half * far:
            return False
        seen, what = self.surfaces.first(self.origin, way / far)
        return what in (-1, cell) or np.linalg.norm(seen - self.origin) >= (1 - 1e-9) * far

    def _reflect(self, order, point, cell, incident, length, share, connected, seen):
        """A hit: the light that it returns to O, and where the rest goes. `seen`: it is known that O sees it."""
        normal = self.surfaces.normals[cell]
        normal = -normal if normal @ incident > 0 else normal
        cosine = -(normal @ incident)
        material = kd, ks, _ = self.surfaces.material(cell)
        back = self.origin - point
        far = np.linalg.norm(back)
        seen = back @ normal > 0 and (seen or self._is_seen(point, cell))
        if seen:
            returned = share * sur(material, cosine, incident, back / far, normal)
            self.throughput[order - 1] += returned * math.exp(-self.attenuation * (length + far))
        if order == ORDERS:
            self.under_way += share * (kd + ks)
            return
        if share * ks * len(self.rays) > LEAST:
            mirror = incident + 2 * cosine * normal
            there, what = self.surfaces.first(point, mirror, cell)
            if there is not None:
                self._reflect(order + 1, there, what, mirror, length + np.linalg.norm(there - point), share * ks,
                              connected, False)
        if seen and connected < self.connections and share * kd * cosine * len(self.rays) > LEAST:
            self._connect(order, point, cell, normal, length, share * kd * cosine, connected)

    def _connect(self, order, point, cell, normal, length, share, connected):
        """On to the hit of another ray, if that is in sight. Each connection of a path has a ray of its own."""
        there, what = self.hits[(self.number + self.shifts[connected]) % len(self.rays)]
        if there is None or what == cell:
            return
        way = there - point
        far = np.linalg.norm(way)
        other = self.surfaces.normals[what]
        other = -other if other @ (there - self.origin) > 0 else other
        if far == 0 or way @ normal <= 1e-9 * far or way @ other >= -1e-9 * far:
            return
        met, which = self.surfaces.first(point, way / far, cell, far)
        if which in (-1, what) or np.linalg.norm(met - point) >= (1 - 1e-9) * far:
            self._reflect(order + 1, there, what, way / far, length + far, share, connected + 1, True)


# --- scenes

def painted(data, material):
    """All of it of one material."""
    return running.painted(data, [("*", material)])


def mirrors(name, quads, towards, floor="Glass"):
    """Glass plates about the origin, the first of another material if named, and the axis of a beam of Airport16 from
    `towards`."""
    towards = np.array(towards) / np.linalg.norm(towards)
    blocks = vtkMultiBlockDataSet()
    blocks.SetBlock(0, painted(running.quads(quads[:1]), floor))
    blocks.SetBlock(1, painted(running.quads(quads[1:]), "Glass"))
    subject = Subject(name, blocks, "Airport16", RANGE * towards)
    subject.axis = -towards
    return subject


def two_mirrors():
    """Perpendicular, with their common edge upright."""
    return mirrors("two perpendicular mirrors", [[(0, 0, -3), (3, 0, -3), (3, 0, 3), (0, 0, 3)],
                                                 [(0, 0, -3), (0, 3, -3), (0, 3, 3), (0, 0, 3)]], (1, 1, 0))


def corner(floor="Glass"):
    """Three perpendicular plates, seen along the diagonal: all mirrors, or two on a floor."""
    name = "three perpendicular mirrors" if floor == "Glass" else "two of them and a wall"
    return mirrors(name, [[(0, 0, 0), (3, 0, 0), (3, 3, 0), (0, 3, 0)], [(0, 0, 0), (3, 0, 0), (3, 0, 3), (0, 0, 3)],
                          [(0, 0, 0), (0, 3, 0), (0, 3, 3), (0, 0, 3)]], (1, 1, 1), floor)


def channel(width=0.2, depth=0.3):
    """Two facing mirrors with a third at the end, entered at 45 degrees."""
    w = 0.5 * width
    return mirrors("U of mirrors, 0.2 m wide and 0.3 m deep",
                   [[(x0, y0, -2), (x1, y1, -2), (x1, y1, 2), (x0, y0, 2)]
                    for x0, y0, x1, y1 in ((-depth, -w, 0, -w), (-depth, w, 0, w), (-depth, -w, -depth, w))], (1, 1, 0))


def outdoors(name, scene, preset, material=None):
    """A scene of trade_runs.py, all of one material if named."""
    surfaces, place, attenuation = trade_runs.scene_of(scene)
    return Subject(name + (f", all of {material.lower()}" if material else ""),
                   painted(surfaces, material) if material else surfaces, preset, place, attenuation)


def corridor(material=None):
    return outdoors("corridor", "corridor", "CorridorC16", material)


# Scenes made from the data folder, where the build has made them.
FROM_DATA = (("Honolulu, 32 channels", "phnl", "Airport32"),
             ("Shanghai, centre, 32 channels", "shanghai_cbd", "Airport32"),
             ("Ingolstadt, 32 channels", "ingolstadt", "Airport32"))


# --- measuring

@dataclasses.dataclass
class Measured:
    """Energies per beam, as shares of the pulse: by order, and of orders one and two by the echo filter; the mean share
    that leaves the last order; Rmax^3; Qlow over Qs."""
    orders: np.ndarray
    filter: np.ndarray
    under_way: float
    bound: float
    limit: float

    @staticmethod
    def mean(energies):
        """Mean over beams, and its standard error."""
        return energies.mean(), energies.std(ddof=1) / math.sqrt(len(energies))

    def share(self, energies):
        """Of what is received, and its standard error (of a ratio)."""
        received = self.orders.sum(axis=1)
        if not received.any():
            return 0.0, 0.0
        ratio = energies.sum() / received.sum()
        return ratio, np.linalg.norm(energies - ratio * received) / received.sum()

    def more(self):
        return self.orders[:, 2:].sum(axis=1)


def chosen_beams(subject, count, random):
    """Beams as input of the filter: all or `count` of the sensor's, or `count` times the same."""
    beams = subject.sensor.GetOutput()
    if subject.axis is None:
        number = beams.GetNumberOfPoints()
        return running.some_beams(beams, np.sort(random.choice(number, min(count, number), replace=False)))
    result = running.some_beams(beams, np.zeros(count, int))
    vtk_to_numpy(result.GetPointData().GetArray("beam_id"))[:] = np.arange(count)
    vtk_to_numpy(result.GetPointData().GetArray("direction"))[:] = subject.axis
    return result


def fields_of(beams):
    """Half beamwidth (rad), energy of the pulse and lower limit (J)."""
    fields = beams.GetFieldData()
    return [fields.GetArray(name).GetValue(0) for name in ("half_beamwidth", "pulse_energy", "lower_energy_limit")]


def places_of(beams):
    """Origins and directions."""
    return vtk_to_numpy(beams.GetPoints().GetData()).astype(float), column(beams, "direction").astype(float)


def by_filter(subject, beams, rays, seed):
    """Energies of orders one and two of each beam, J, by the echo filter, after its limits and its gate are set
    wide."""
    for name, value in (("lower_energy_limit", 1e-18), ("upper_energy_limit", 1.0), ("range_gate", 1e6)):
        beams.GetFieldData().GetArray(name).SetValue(0, value)
    ids, sums = column(beams, "beam_id"), []
    for reflections in (1, 2):
        echoes = running.scanned(beams, subject.tree, AttenuationCoefficient=subject.attenuation, RaysPerBeam=rays,
                                 Seed=seed, NumberOfReflections=reflections, FullModel=True, Noise=False).GetOutput()
        sums.append(np.bincount(np.searchsorted(ids, column(echoes, "beam_id")), column(echoes, "return_energy"),
                                len(ids)))
    return np.column_stack([sums[0], sums[1] - sums[0]])


def measure(subject, count, rays, seed=0):
    """`count` beams at random, `rays` rays in each."""
    random = np.random.default_rng(seed)
    beams = chosen_beams(subject, count, random)
    half, pulse, limit = fields_of(beams)
    surfaces = Surfaces(subject.tree.GetOutput())
    traced = [Beam(surfaces, origin, axis, half, rays_of(axis, half, rays, random), subject.attenuation, random)
              for origin, axis in zip(*places_of(beams))]
    return Measured(np.array([beam.throughput for beam in traced]), by_filter(subject, beams, rays, seed) / pulse,
                    float(np.mean([beam.under_way for beam in traced])), surfaces.most ** 3, limit / pulse)


def percent(value, error):
    """In per cent, with its standard error."""
    value, error = 100 * value, 100 * error
    if error <= 1e-9 * value:
        return f"{value:.4g}"  # one beam, integrated
    if value < 0.01:
        return f"{value:.1e} ± {error:.0e}"
    digits = max(0, (1 if error > 5e-4 else 0) - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def row(found):
    """(column, text): energies as a share of the pulse, mean of the beams."""
    orders, more = found.orders, found.more()
    return [("1 (% of Qs)", percent(*found.mean(orders[:, 0]))),
            ("1, echo filter", percent(*found.mean(found.filter[:, 0]))), ("2", percent(*found.mean(orders[:, 1]))),
            ("2, echo filter", percent(*found.mean(found.filter[:, 1]))), ("3", percent(*found.mean(orders[:, 2]))),
            ("4 to 8", percent(*found.mean(orders[:, 3:].sum(axis=1)))),
            ("3 to 8, % of all received", percent(*found.share(more))),
            ("most in a beam (% of Qs)", f"{100 * more.max():.2g}"),
            ("beams with more than Qlow of 3 to 8", f"{(more > found.limit).sum()} of {len(more)}")]


@study(argument("--beams", type=whole(2, 1000000), default=2000, help="of each scene, default 2000"),
       argument("--rays", type=whole(1, 100000), default=30, help="rays per beam, default 30"),
       argument("--seed", type=whole(0, 2**31 - 1), default=0, help="of the random numbers, default 0"))
def main(options):
    few = max(2, options.beams // 10)  # the same beam again and again
    sets = {"more-reflections": [
        (few, two_mirrors), (few, corner), (few, lambda: corner("Wall")), (few, channel), (options.beams, corridor),
        (options.beams, lambda: corridor("Glass")),
        *((4 * options.beams, lambda p=p, m=m: outdoors(f"Hongqiao, {p} channels", "airport", f"Airport{p}", m))
          for p, m in ((16, None), (32, None), (32, "Glass")))]}
    sets["more-reflections-elsewhere"] = [
        (options.beams, lambda n=name, f=built_scene(file), p=preset: outdoors(n, f, p))
        for name, file, preset in FROM_DATA if built_scene(file)]
    for name, scenes in sets.items():
        rows = []
        for count, make in scenes:
            one = make()
            found = measure(one, count, options.rays, options.seed)
            print(f"{one.name}: {100 * found.under_way:.2g} % of Qs go on after order {ORDERS}; Rmax^3 is "
                  f"{100 * found.bound:.1f} %")
            rows.append({"": one.name, **dict(row(found))})
        if rows:
            tools.leave(options.out, name, list(rows[0]), [list(row.values()) for row in rows])
