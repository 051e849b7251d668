# SPDX-License-Identifier: BSD-3-Clause
"""What share of strips and approaches at Hongqiao four receivers cover, by species; and the seconds of a first map and
of an evaluation of sites.

    Testing/Studies/run.py coverage_costs
"""
import numpy as np

import avianlidar as al
import tools
from avianlidar import siting
from running import AIRPORT, FOOTPRINTS, seconds_of, study

SPECIES = ("starling", "kestrel", "pigeon", "crow", "herring gull", "Canada goose")
SENSORS = ("Search905", "Search1550", "Automotive16", "Airport16")


def shares(scene, runways):
    """Of 12,000 places: {sensor: {species: row of the table}}."""
    middle = 0.5 * (np.array(runways[0].start) + runways[0].end)
    places = al.places_of(*siting.strips_and_approaches(runways, 12000, 1))
    for name in SENSORS:
        cover = al.Coverage(scene, al.Sensor(name, position=(*middle, 3.0)), places=places, all_species=True)
        yield name, {row["species"]: row for row in cover.table if row["region"] == "all"
                     and row["height_to"] == np.inf and row["height_from"] == -np.inf}


def first_map(scene):
    """Places and seconds of a map 4 km wide; the tree is there."""
    x, y, z = scene.lidar_position
    cover = al.Coverage(scene, al.Sensor("Search905", position=(x, y, z)), spacing=(10.0, 10.0, 2.4), species="pigeon",
                        bounds=(x - 2000, x + 2000, y - 2000, y + 2000, z - 3, z + 147))
    seconds = seconds_of(cover.update)
    return cover.data.GetNumberOfPoints(), seconds


def evaluation(scene, runways):
    """Sites, and seconds of their evaluation at 12,000 places for three species, on one thread."""
    outlines = siting.read_outlines(FOOTPRINTS, scene.geodetic_origin, "height")
    outlines += [siting.runway_outline(runway) for runway in runways]
    lattice = siting.lattice((-2000, 1600, -2200, 2200), 200)
    sites = siting.candidates(lattice, (5.0,), [(outline, 0.0) for outline in outlines])
    points, _ = siting.strips_and_approaches(runways, 12000)
    species = ["starling", "herring gull", "Canada goose"]
    return len(sites), seconds_of(lambda: siting.look(scene, al.Sensor("Search905"), sites, points, species))


@study()
def main(options):
    scene = al.load_scene(AIRPORT)
    scene.tree.Update()
    runways = siting.read_runways(FOOTPRINTS, scene.geodetic_origin)
    tools.leave(options.out, "coverage-species", ("sensor", *SPECIES), [
        (name, *(f"{row[s]['detection_probability']:.3f} ± {row[s]['detection_std_error']:.3f}" for s in SPECIES))
        for name, row in shares(scene, runways)])
    for what, (count, seconds) in (("places of a first map", first_map(scene)), ("sites", evaluation(scene, runways))):
        print(f"{count:,} {what}: {seconds:.2f} s")
