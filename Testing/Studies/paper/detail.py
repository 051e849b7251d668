# SPDX-License-Identifier: BSD-3-Clause
"""Does a simplified model do (paper, Sec. 1)? Scans the same 53 buildings twice: as they are modelled, with windows,
doors, balconies and roofs (level of detail 3), and as blocks, the outlines of their ground surfaces raised to the mean
height of their roofs (level of detail 1). Leaves a table and a CSV of how the echoes differ. Needs the buildings of
Ingolstadt in the folder AVIANLIDAR_DATA_DIR.

    AVIANLIDAR_DATA_DIR=/path/to/data Testing/Studies/run.py detail
"""
import collections
import gzip
import sys

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet

import avianlidar as al
import tools
import trade_runs
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter
from running import painted
from running import argument, study, whole

FILE = "mesh_ingolstadt_lod3/ingolstadt_lod3.obj.gz"
MAST = 3.0  # m above the ground
AWAY = 500.0  # m from the middle of the buildings, as far as the paper's lidar is from Terminal 1
GLASS = "Window"


def read(file):
    """{building: {surface type: triangles, n x 3 x 3}}; the file has metres, z up, one object a building."""
    places, found, building, surface = [], collections.defaultdict(lambda: collections.defaultdict(list)), "", ""
    with gzip.open(file, "rt", encoding="utf-8") as lines:
        for line in lines:
            kind, *words = line.split() or [""]
            if kind == "v":
                places.append([float(word) for word in words[:3]])
            elif kind == "o":
                building = words[0]
            elif kind == "usemtl":
                surface = words[0].split("__")[0]
            elif kind == "f":
                corners = [int(word.split("/")[0]) for word in words]
                found[building][surface] += [(corners[0], a, b) for a, b in zip(corners[1:], corners[2:])]
    places = np.array(places)
    return {name: {kind: places[np.array(rows) - 1] for kind, rows in surfaces.items()}
            for name, surfaces in found.items()}


def roof_height(surfaces):
    """The mean height of the roofs, by their area seen from above, m."""
    roofs = surfaces.get("RoofSurface", np.zeros((0, 3, 3)))
    plan = abs(np.cross(roofs[:, 1] - roofs[:, 0], roofs[:, 2] - roofs[:, 0])[:, 2])
    return np.average(roofs[:, :, 2].mean(axis=1), weights=plan) if plan.sum() > 0 else max(
        part[:, :, 2].max() for part in surfaces.values())


def block(surfaces):
    """A building of level of detail 1: its ground, the same as a flat roof, and walls along the edges that one triangle
    has."""
    ground, top = surfaces["GroundSurface"], roof_height(surfaces)
    edges, where = collections.Counter(), {}
    for triangle in ground:
        keys = [tuple(np.round(corner[:2], 3)) for corner in triangle]
        for i in range(3):
            a, b = keys[i], keys[(i + 1) % 3]
            if a != b:
                edges[frozenset((a, b))] += 1
                where[frozenset((a, b))] = triangle[i], triangle[(i + 1) % 3]
    roof = ground.copy()
    roof[:, :, 2] = top
    walls = []
    for edge, times in edges.items():
        if times == 1:
            a, b = where[edge]
            upper_a, upper_b = (*a[:2], top), (*b[:2], top)
            walls += [(a, b, upper_b), (a, upper_b, upper_a)]
    return {"GroundSurface": ground, "RoofSurface": roof, "WallSurface": np.array(walls)}


def scene_of(buildings, glass):
    """One block for each building, all wall, or with windows of glass."""
    scene, count = vtkMultiBlockDataSet(), 0
    for name, surfaces in buildings.items():
        for kind in ("", GLASS):
            parts = [triangles for one, triangles in surfaces.items()
                     if (one == GLASS) == (kind == GLASS) and len(triangles)]
            if parts:
                corners = np.concatenate(parts)
                data = al.mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
                scene.SetBlock(count, data)
                scene.GetMetaData(count).Set(scene.NAME(), f"{kind}{name}")
                count += 1
    has_glass = glass and any(GLASS in one for one in buildings.values())
    return painted(scene, [("*", "Wall"), *([(f"{GLASS}*", "Glass")] if has_glass else [])])


def places(buildings):
    """Beside the first building, where the scene's lidar stands, and 500 m from the middle of all in four
    directions."""
    everything = np.concatenate([part.reshape(-1, 3) for surfaces in buildings.values() for part in surfaces.values()])
    middle = 0.5 * (everything[:, :2].min(axis=0) + everything[:, :2].max(axis=0))
    ground = np.percentile(everything[:, 2], 1)
    result = {"beside the first": (0.0, 0.0, MAST)}
    for name, x, y in (("north", 0, 1), ("east", 1, 0), ("south", 0, -1), ("west", -1, 0)):
        result[f"500 m {name}"] = (middle[0] + AWAY * x, middle[1] + AWAY * y, ground + MAST)
    return result


def compare(detailed, simple, options):
    """What the simple model misses, invents and gets wrong, against the converged echoes of the detailed one."""
    truth = trade_runs.Reference(detailed, options.rays)
    settings = {"RaysPerBeam": options.rays, "BeamSamples": Filter.BEAM_SAMPLES_RAYS}
    found = trade_runs.scan(simple, settings, 0, 0)
    judged = trade_runs.judge(truth, found)
    true = judged["true"]
    paper = trade_runs.judge(truth, trade_runs.scan(detailed, {**settings, "RaysPerBeam": 100, "Sampling": 0}, 0, 0))
    again = trade_runs.judge(truth, trade_runs.scan(detailed, settings, 1, 0))
    matched = judged["energy"][judged["energy"] > -1]
    beams = [set(one["beam_id"]) for one in (truth.echoes, found.echoes)]
    energies = [one["return_energy"].sum() for one in (found.echoes, truth.echoes)]
    return {"echoes, detailed": true, "echoes, blocks": len(found.echoes["beam_id"]),
            "missed": f"{100 * judged['missed'] / true:.0f} %", "invented": f"{100 * judged['false'] / true:.0f} %",
            "beams with echoes in one only": f"{100 * len(beams[0] ^ beams[1]) / len(beams[0] | beams[1]):.0f} %",
            "rms error of energy, where found": f"{100 * trade_runs.rms(matched):.0f} %",
            "median error of range (m)": f"{np.median(abs(judged['range'])):.2f}",
            "energy of all, blocks / detailed": f"{energies[0] / energies[1]:.2f}",
            "other rays, detailed: missed": f"{100 * again['missed'] / true:.1f} %",
            "other rays, detailed: invented": f"{100 * again['false'] / true:.1f} %",
            "100 random rays, detailed: missed": f"{100 * paper['missed'] / true:.0f} %",
            "100 random rays, detailed: invented": f"{100 * paper['false'] / true:.0f} %"}


@study(argument("--rays", type=whole(100, 1000000), default=2000, help="of a beam, default 2000"),
       argument("--coarser", type=whole(1, 100), default=1, help="steps of azimuth, default 1 times the sensor's"),
       data=[FILE])
def main(options):
    file = options.data / FILE
    detailed = {name: surfaces for name, surfaces in read(file).items() if len(surfaces.get("GroundSurface", ()))}
    blocks = {name: block(surfaces) for name, surfaces in detailed.items()}
    count = [sum(len(part) for surfaces in one.values() for part in surfaces.values()) for one in (detailed, blocks)]
    print(f"{len(blocks)} buildings, {count[0]} triangles, as blocks {count[1]}")
    rows = []
    for glass in (False, True):
        for name, place in places(detailed).items():
            found = compare(*(
                trade_runs.Subject("Ingolstadt", scene_of(one, glass), "Airport16", place, coarser=options.coarser)
                for one in (detailed, blocks)), options)
            rows.append({"lidar, materials": f"{name}, {'windows of glass' if glass else 'all wall'}", **found})
            print(*rows[-1].values(), sep=" | ", file=sys.stderr, flush=True)
    tools.leave(options.out, "table", ("", *list(rows[0])[1:]), [list(row.values()) for row in rows])
    return rows
