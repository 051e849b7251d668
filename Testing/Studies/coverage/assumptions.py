# SPDX-License-Identifier: BSD-3-Clause
"""What do assumptions change? Prints a table: the share of 12,000 places in strips and approaches at Hongqiao where one scan
detects a bird, as assumed and with one assumption changed at a time.

    Testing/Studies/run.py assumptions
    Testing/Studies/run.py assumptions --sensor Search1550 --rows 3
"""
import numpy as np

import avianlidar as al
import tools
from avianlidar import siting
from running import AIRPORT, FOOTPRINTS, argument, study

CHANGES = (("as assumed", {}, {}),
           ("plumage of reflectance 0.15", {}, {"reflectance": 0.15}), ("plumage of reflectance 0.6", {}, {"reflectance": 0.6}),
           ("effective area 20 % smaller", {}, {"area": 0.8}), ("effective area 20 % larger", {}, {"area": 1.2}),
           ("the bird glides", {}, {"gliding": True}),
           ("visibility 5 km", {}, {"visibility": 5e3}), ("visibility 50 km", {}, {"visibility": 50e3}),
           ("night", {"background_radiance": 0.0}, {}), ("background twice as bright", {"background_radiance": 0.1}, {}),
           ("efficiency of the receiver 0.2", {"receiver_efficiency": 0.2}, {}),
           ("amplifier noise 120 electrons", {"amplifier_noise": 120.0}, {}),
           ("excess noise factor 5", {"excess_noise_factor": 5.0}, {}),
           ("100 false alarms a scan", {"false_alarms_per_scan": 100.0}, {}),
           ("a pulse that no two range units share", {"pulse_width": 0.0}, {}),
           ("a Gaussian beam", {"beam_profile": "Gaussian"}, {}))


@study(argument("--sensor", default="Search905", help="default Search905"),
       argument("--rows", type=int, default=len(CHANGES), help="of the table, default all"))
def main(options):
    scene = al.load_scene(AIRPORT)
    runways = siting.read_runways(FOOTPRINTS, scene.geodetic_origin)
    places = al.places_of(*siting.strips_and_approaches(runways, 12000))
    usual, rows, names = {}, [], ("herring gull", "starling")
    for words, of_sensor, of_target in CHANGES[:options.rows]:
        cells = []
        for species in names:
            settings = dict(of_target)
            share = settings.pop("area", None)
            if share is not None:
                settings["effective_area"] = share * usual[species][1]
            cover = al.Coverage(scene, al.Sensor(options.sensor, position=scene.lidar_position, **of_sensor), places=places,
                                species=species, **settings)
            found = float(np.mean(cover["detection_probability"]))
            usual.setdefault(species, (found, cover.data.GetFieldData().GetArray("effective_area").GetValue(0)))
            cells.append(f"{found:.3f} ({found - usual[species][0]:+.3f})")
        rows.append((words, *cells))
    tools.leave(options.out, "table", ("changed", *names), rows)
