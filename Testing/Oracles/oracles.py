#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Echoes that are known in closed form, for any simulator of beams: prints them as JSON. README.md has the derivations.

    /usr/bin/python3 Testing/Oracles/oracles.py

Everything is computed with mpmath at 30 digits from the formulas alone, but for the diffuse connections of the V,
a four-dimensional integral by Gauss-Legendre quadrature in double precision. Needs mpmath and numpy, nothing else.
"""
import json
import math

import mpmath as mp
import numpy as np

mp.mp.dps = 30
QS = mp.mpf("3.6e-4")
T = mp.mpf("5.6e-3")
C = mp.mpf(299792458)
DIFFUSE, WALL = ("0.146", "0", "0"), ("0.146", "0.054", "112")
GLASS = ("0.020", "0.852", "8046")


def degrees(angle):
    return mp.mpf(angle) * mp.pi / 180


def versine(t):
    """1 - cos t, without cancellation."""
    return 2 * mp.sin(t / 2) ** 2


def azimuths(beta, alpha, t):
    """Half of the azimuths about a plane's normal for which the direction at the angle beta from that normal lies in
    the cone of half angle t, whose axis is at the angle alpha from the normal."""
    if alpha == 0:
        return mp.pi if beta <= t else mp.mpf(0)
    cosine = (mp.cos(t) - mp.cos(beta) * mp.cos(alpha)) / (mp.sin(beta) * mp.sin(alpha)) if beta else mp.mpf(-2)
    return mp.pi if cosine <= -1 else mp.mpf(0) if cosine >= 1 else mp.acos(cosine)


def plane(t, alpha, distance, mu, material):
    """Energy of a plane that fills the cone, met by the axis at the incidence alpha and the given distance."""
    kd, ks, kp = map(mp.mpf, material)
    height = distance * mp.cos(alpha)

    def density(beta):
        lobe = ks * max(mp.mpf(0), mp.cos(2 * beta)) ** kp if ks else 0
        air = mp.exp(-2 * mu * height / mp.cos(beta))
        return 2 * azimuths(beta, alpha, t) * mp.sin(beta) * (kd * mp.cos(beta) + lobe) * air

    low, high = max(mp.mpf(0), alpha - t), alpha + t
    lobe_turns = (x for x in narrow(ks, kp) if low < x < high)
    turns = sorted({low, abs(t - alpha) if alpha else t, alpha, high, *lobe_turns})
    return QS * mp.quad(density, turns) / (2 * mp.pi * versine(t))


def narrow(ks, kp):
    """Where to cut the integral of a lobe that is narrower than the beam."""
    return [mp.mpf(i) / mp.sqrt(kp) for i in (1, 2, 4)] if ks and kp > 1000 else []


def sphere(radius, distance, t, kd):
    """Smooth diffuse sphere with its centre on the axis; the lidar outside or inside."""
    b = (mp.mpf(distance) / radius) ** 2
    a = 1 - b

    def antiderivative(u):
        root = mp.sqrt(a + b * u * u)
        return u * root / 2 + a / (2 * mp.sqrt(b)) * mp.log(mp.sqrt(b) * u + root)

    edge = mp.cos(min(t, mp.asin(1 / mp.sqrt(b)))) if b > 1 else mp.cos(t)
    return QS * kd * (antiderivative(mp.mpf(1)) - antiderivative(edge)) / versine(t)


def cut(epsilon, t, kd):
    """Energy of a wall normal to the axis that begins at the angle epsilon from it."""
    phi = mp.acos(mp.tan(epsilon) / mp.tan(t))
    omega = 2 * mp.pi * versine(t)
    return QS * kd / omega * (phi * mp.sin(t) ** 2 - mp.sin(epsilon) * mp.atan(mp.sin(epsilon) * mp.tan(phi)))


def dihedral(t, kd, sign):
    """Two plates at 45 degrees to the axis whose common edge crosses it; +1 concave, -1 convex."""
    return QS * kd / mp.sqrt(2) * ((1 + mp.cos(t)) / 2
                                   + sign * (t - mp.sin(t) * mp.cos(t)) / (mp.pi * versine(t)))


class Ground:
    """A level diffuse plane a height below the lidar, the axis an angle below the horizon."""

    def __init__(self, height, depression, t, kd, mu=0):
        self.height, self.depression, self.t, self.kd, self.mu = mp.mpf(height), depression, t, kd, mp.mpf(mu)
        self.near = self.height / mp.sin(depression + t)
        self.far = self.height / mp.sin(depression - t)

    def density(self, r):
        """dE/dr."""
        s = self.height / r
        cosine = (mp.cos(self.t) - s * mp.sin(self.depression)) / (mp.sqrt(1 - s * s) * mp.cos(self.depression))
        phi = mp.acos(max(mp.mpf(-1), min(mp.mpf(1), cosine)))
        omega = 2 * mp.pi * versine(self.t)
        return 2 * QS * self.kd * self.height**2 * phi / (omega * r**3) * mp.exp(-2 * self.mu * r)

    def between(self, low, high):
        low, high = max(low, self.near), min(high, self.far)
        return mp.quad(self.density, [low, (low + high) / 2, high]) if high > low else mp.mpf(0)

    def unit(self, m, tau_s):
        """Energy of the range unit m for a pulse without length."""
        step = C * tau_s / 2
        return self.between(m * step, (m + 1) * step)

    def spread_unit(self, m, tau_s):
        """The same for a pulse as long as the unit, centred on the delay: each range gives its overlap."""
        step = C * tau_s / 2
        middle = (m + mp.mpf(1) / 2) * step

        def weighed(r):
            return self.density(r) * max(mp.mpf(0), 1 - abs(r - middle) / step)

        low, high = max(middle - step, self.near), min(middle + step, self.far)
        if not high > low:
            return mp.mpf(0)
        return mp.quad(weighed, sorted({low, min(max(middle, low), high), high}))


def gaussian_plane(t, kd):
    """Profile exp(-2u), u = (1 - cos)/(1 - cos t), cut at u = 1, on a plane at normal incidence."""
    tail = mp.exp(-2)
    return QS * kd * (1 - versine(t) * (1 - 3 * tail) / (2 * (1 - tail)))


def gaussian_edge_energy(epsilon, t, kd):
    """Energy beyond the edge: the cosine of incidence is that of theta."""
    def density(theta):
        u = versine(theta) / versine(t)
        return mp.sin(theta) * mp.cos(theta) * mp.exp(-2 * u) * mp.acos(mp.tan(epsilon) / mp.tan(theta)) / mp.pi

    return QS * kd * mp.quad(density, [epsilon, (epsilon + t) / 2, t]) / (versine(t) * (1 - mp.exp(-2)) / 2)


def groove_product(t, gap, order):
    """Mean over ordered pairs of directions of the cone of cos(theta1) cos(theta2) for the V x = 100 - |y|, |y| >= gap:
    incidence on the first plate from the lidar, on the second plate from the first. Double precision."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    tangent, omega = math.tan(t), 2 * math.pi * 2 * math.sin(t / 2) ** 2
    # Direction (1, u, v)/norm; on the plate y > 0 x = 100/(1 + u), so y >= gap means u >= gap/(100 - gap).
    first = gap / (100 - gap)
    angle_low = math.asin(first / tangent)
    psi = 0.5 * (nodes + 1) * (math.pi / 2 - angle_low) + angle_low  # u = tangent sin(psi): smooth at both ends
    u = tangent * np.sin(psi)
    du = tangent * np.cos(psi) * weights * (math.pi / 2 - angle_low) / 2
    half = tangent * np.cos(psi)
    v = np.outer(half, nodes)
    norm = np.sqrt(1 + u[:, None] ** 2 + v**2)
    share = np.outer(du * half, weights) / norm**3 / omega
    x = np.broadcast_to((100 / (1 + u))[:, None], v.shape)
    places = np.stack([x, u[:, None] * x, v * x], axis=-1).reshape(-1, 3)
    lit = ((1 + u)[:, None] / norm / math.sqrt(2) * share).ravel()  # times cos(theta1); normal (-1, -1, 0)/sqrt(2)
    share = share.ravel()
    other = places * (1, -1, 1)  # the plate y < 0, by symmetry, normal (-1, 1, 0)/sqrt(2)
    total = 0.0
    for place, weight in zip(places, lit):
        leg = other - place
        cosine = -(leg @ np.array([-1.0, 1.0, 0.0])) / math.sqrt(2) / np.linalg.norm(leg, axis=1)
        total += weight * (cosine @ share)
    return 2 * total


# ---- Scenes: the lidar at the origin, the axis along x unless said.

def plate(center, one, other):
    """A parallelogram as two triangles; one and other are half of its sides."""
    center, one, other = (np.array([float(x) for x in v]) for v in (center, one, other))
    a, b, c, d = center - one - other, center + one - other, center + one + other, center - one + other
    return [[list(map(float, p)) for p in (a, b, c)], [list(map(float, p)) for p in (a, c, d)]]


def tilted_plate(alpha, distance, size):
    """Met by the axis at the incidence alpha, turned about z."""
    return plate((distance, 0, 0), (size * mp.sin(alpha), size * mp.cos(alpha), 0), (0, 0, size))


def groove(sign, gap=0, size=50):
    """Two plates at 45 degrees to the axis that meet, or would, at x = 100; +1: they open to the lidar."""
    half, first, across = size / 2, float(gap), 20.0
    middle = first + half
    return (plate((100 - sign * middle, middle, 0), (-sign * half, half, 0), (0, 0, across))
            + plate((100 - sign * middle, -middle, 0), (-sign * half, -half, 0), (0, 0, across)))


def number(value):
    return float(mp.nstr(value, 17)) if isinstance(value, mp.mpf) else value


def case(name, section, scene, expected, material=DIFFUSE, t=T, mu=0, profile="uniform", axis=(1.0, 0.0, 0.0),
         paths=1, tolerance=1e-9, **more):
    kd, ks, kp = map(float, material)
    return {"name": name, "section": section,
            "beam": {"origin_m": [0.0, 0.0, 0.0], "direction": list(map(number, axis)), "half_beamwidth_rad": number(t),
                     "profile": profile, "pulse_energy_J": float(QS)},
            "attenuation_per_m": float(mu), "material": {"kd": kd, "ks": ks, "kp": kp}, "reflections": paths,
            "scene": scene, "expected": {k: number(v) for k, v in expected.items()},
            "relative_tolerance": tolerance, **more}


def planes():
    kd, cases = mp.mpf(DIFFUSE[0]), []
    for t in ("1e-9", "1e-4", "5.6e-3", "0.1", "0.5", "1"):
        cases.append(case(f"plane, normal, t = {t}", 1, {"triangles": tilted_plate(mp.mpf(0), 100, 1000)},
                          {"energy_J": QS * kd * (1 + mp.cos(mp.mpf(t))) / 2}, t=mp.mpf(t)))
    mu = mp.mpf("3.5e-5")
    wide = mp.mpf("0.1")
    for name, material, t in (("wall", WALL, T), ("wall, wide", WALL, wide), ("glass", GLASS, T),
                              ("diffuse", DIFFUSE, T)):
        cases.append(case(f"plane, normal, in air, {name}", 1, {"triangles": tilted_plate(mp.mpf(0), 500, 1000)},
                          {"energy_J": plane(t, mp.mpf(0), mp.mpf(500), mu, material)}, material, t, mu))
    glint = ("0", "0.852", "1000000")
    cases.append(case("glint narrower than the beam", 1, {"triangles": tilted_plate(mp.mpf(0), 100, 1000)},
                      {"energy_J": plane(T, mp.mpf(0), mp.mpf(100), 0, glint)}, glint))
    for alpha, t in (("60", T), ("80", T), ("60", mp.mpf("0.1"))):
        angle = degrees(alpha)
        mean = 100 / ((1 + mp.cos(t)) / 2)
        cases.append(case(f"plane, {alpha} deg, diffuse, t = {mp.nstr(t, 3)}", 2,
                          {"triangles": tilted_plate(angle, 100, 1000)},
                          {"energy_J": QS * kd * mp.cos(angle) * (1 + mp.cos(t)) / 2, "mean_range_m": mean}, t=t))
    cases.append(case("plane, 89 deg, diffuse, mean range", 2,
                      {"triangles": tilted_plate(degrees(89), "171.8960655", 1000)},
                      {"energy_J": QS * kd * mp.cos(degrees(89)) * (1 + mp.cos(T)) / 2,
                       "mean_range_m": mp.mpf("171.8960655") / ((1 + mp.cos(T)) / 2)}))
    wall, glass = ("0", "0.054", "112"), ("0", "0.852", "8046")
    for alpha, material in (("2", wall), ("0.3", glass), ("0.6", glass)):
        cases.append(case(f"plane, {alpha} deg, specular, kp = {material[2]}", 2,
                          {"triangles": tilted_plate(degrees(alpha), 100, 1000)},
                          {"energy_J": plane(T, degrees(alpha), mp.mpf(100), 0, material)}, material))
    cases.append(case("plane, 70 deg, wall, in haze", 2, {"triangles": tilted_plate(degrees(70), 500, 1000)},
                      {"energy_J": plane(T, degrees(70), mp.mpf(500), mp.mpf("1e-3"), WALL)}, WALL, mu=mp.mpf("1e-3")))
    return cases


def others():
    kd, cases = mp.mpf(DIFFUSE[0]), []
    for name, radius, distance, t in (("underfills the beam", 5, 1000, T), ("lidar inside, t = 1", 50, 30, mp.mpf(1))):
        cases.append(case(f"sphere, {name}", 3,
                          {"sphere": {"centre_m": [float(distance), 0.0, 0.0], "radius_m": float(radius)}},
                          {"energy_J": sphere(radius, distance, t, kd)}, t=t))
    for epsilon in ("0", "2e-3", "5e-3"):
        edge = 100 * mp.tan(mp.mpf(epsilon))
        cases.append(case(f"edge at {epsilon} rad", 4,
                          {"triangles": plate((100, edge + 50, 0), (0, 50, 0), (0, 0, 50))},
                          {"energy_J": cut(mp.mpf(epsilon), T, kd)}))
    for name, sign in (("concave", 1), ("convex", -1)):
        cases.append(case(f"dihedral, {name}", 5, {"triangles": groove(sign)}, {"energy_J": dihedral(T, kd, sign)}))
    cases += grounds() + two_plates()
    for t in (T, mp.mpf("0.5")):
        cases.append(case(f"Gaussian beam, plane, t = {mp.nstr(t, 3)}", 8,
                          {"triangles": tilted_plate(mp.mpf(0), 100, 1000)},
                          {"energy_J": gaussian_plane(t, kd)}, t=t, profile="gaussian"))
    edge = 100 * mp.tan(mp.mpf("2e-3"))
    cases.append(case("Gaussian beam, edge at 2e-3 rad", 8,
                      {"triangles": plate((100, edge + 50, 0), (0, 50, 0), (0, 0, 50))},
                      {"energy_J": gaussian_edge_energy(mp.mpf("2e-3"), T, kd)}, profile="gaussian"))
    return cases


def grounds():
    kd, tau, cases = mp.mpf(DIFFUSE[0]), mp.mpf("5e-9"), []
    scene = {"triangles": plate((0, 0, -3), (5000, 0, 0), (0, 5000, 0))}
    units = (173, 174, 190, 194, 200, 250, 300, 337)
    for mu in (mp.mpf(0), mp.mpf("3.5e-5")):
        ground = Ground(3, degrees(1), T, kd, mu)
        total = ground.between(ground.near, ground.far)
        cases.append(case(f"ground at 1 deg, {'no air' if not mu else 'in air'}", 6, scene,
                          {"energy_J": total, "nearest_m": ground.near, "farthest_m": ground.far}, mu=mu,
                          axis=(mp.cos(degrees(1)), mp.mpf(0), -mp.sin(degrees(1))),
                          waveform={"sampling_interval_s": 5e-9,
                                    "units": {"pulse 0 s": {str(m): number(ground.unit(m, tau)) for m in units},
                                              "pulse 5e-9 s, centred": {str(m): number(ground.spread_unit(m, tau))
                                                                        for m in (173, *units[1:])}}}))
    omega = 2 * mp.pi * versine(T)
    # So low that what lies beyond the plate holds 1e-7 of the energy; the height does not matter.
    low = {"triangles": plate((0, 0, "-0.01"), (10000, 0, 0), (0, 10000, 0))}
    cases.append(case("ground, axis on the horizon", 6, low,
                      {"energy_J": QS * kd * (T - mp.sin(T) * mp.cos(T)) / omega}, tolerance=1e-6))
    return cases


def two_plates():
    product, kd = groove_product(float(T), 0.1, 44), float(DIFFUSE[0])
    return [case("V, diffuse connections", 7, {"triangles": groove(1, 0.1)},
                 {"secondary_energy_J": float(QS) * kd**2 * product}, paths=2, tolerance=1e-9)]


def compute():
    return {
        "about": "Echo energies of one lidar beam in closed form; conventions and derivations are in README.md",
        "units": "SI; angles in rad; energies at the receiver in J, before any noise and dynamic range",
        "cases": planes() + others()}


if __name__ == "__main__":
    print(json.dumps(compute(), indent=1))
