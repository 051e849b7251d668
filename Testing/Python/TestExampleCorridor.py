# SPDX-License-Identifier: BSD-3-Clause
"""The corridor example: what the paper's text observes in Sec. 5.2, as assertions on the scan of the built scene."""
import unittest

import numpy as np

import avianlidar as al
import exampletools as et
import corridor
import corridor_scene

WALL, GLASS, METAL, WOOD = range(4)
PULSE, LOW, HIGH = 2.5e-4, 2e-6, 6.25e-5


class Corridor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = et.folder("ExampleCorridor")
        cls.scene, cls.echoes, cls.lidar = corridor.main(["--no-pictures", "--out", cls.folder])
        cls.names = et.strings(cls.echoes, "object_names")
        cls.found = et.arrays(cls.echoes)
        cls.pure = cls.found["label_share"] > 0.999  # the whole echo comes from one object

    def on(self, name, *more):
        """Which echoes come from an object."""
        mask = self.found["object_id"] == self.names.index(name)
        for m in more:
            mask &= m
        self.assertTrue(mask.any(), name)
        return mask

    def median(self, mask, array="return_energy"):
        return np.median(self.found[array][mask])

    def test_materials_are_those_of_table_1(self):
        rows = {"North wall": (0.146, 0.054, 112), "Bulletin board": (0.020, 0.852, 8046),
                "Hydrant cabinet": (0.020, 0.852, 8046), "Window of the door": (0.020, 0.852, 8046),
                "Handrail": (0.075, 0.634, 6803), "Handrail post 1": (0.075, 0.634, 6803), "Door": (0.107, 0.100, 82)}
        blocks = dict(zip(corridor_scene.names(self.scene), range(self.scene.GetNumberOfBlocks())))
        for name, row in rows.items():
            cells = self.scene.GetBlock(blocks[name]).GetCellData()
            self.assertEqual(tuple(cells.GetArray(k).GetTuple1(0) for k in ("kd", "ks", "kp")), row, name)

    def test_sensor_is_that_of_table_2(self):
        table = {"half_beamwidth": 5.6e-3, "rays_per_beam": 100,
                 "noise_photon_rate": 20e3, "frequency": 3.313e14, "pulse_energy": PULSE, "upper_energy_limit": HIGH,
                 "lower_energy_limit": LOW, "number_of_channels": 16, "elevation_step": 2, "azimuth_step": 2}
        for name, value in table.items():
            self.assertEqual(et.number(self.echoes, name), value, name)
        self.assertAlmostEqual(et.number(self.echoes, "attenuation_coefficient"), 8.8e-5, delta=1e-18)

    def test_the_scene_is_closed(self):
        status = et.vtk_to_numpy(self.lidar.GetOutput(1).GetPointData().GetArray("status"))
        self.assertEqual(len(status), 180 * 16)
        self.assertEqual(set(status), {0, 2})  # every beam meets something; some echoes are too weak

    def test_energies_follow_the_reflectance_model(self):
        # All of the energy of such beams is perceived; the mean over the cone differs a little, as the cone is narrow.
        share = self.found["return_energy"] / et.expected_energy(self.found, PULSE, 8.8e-5)
        for name in ("North wall", "Near end", "Door"):
            whole = self.on(name, self.found["label_share"] > 0.9999, self.found["incidence_angle"] < 35)
            np.testing.assert_allclose(share[whole], 1, atol=2e-3, err_msg=name)
        self.assertLess(share[self.pure & (self.found["secondary_share"] < 0.01)].max(), 1.02)

    def test_walls_are_stronger_than_wood_and_wood_than_glass(self):
        found = self.found
        for low, high in ((5, 8), (8, 11), (11, 14), (14, 17)):
            here = self.pure & (found["incidence_angle"] >= low) & (found["incidence_angle"] < high)
            for energy in ("return_energy", "energy"):
                wall, wood, glass = (self.median(here & (found["material_id"] == material), energy)
                                     for material in (WALL, WOOD, GLASS))
                self.assertGreater(wall, wood, (low, energy))
                self.assertGreater(wood, 3 * glass, (low, energy))
            # Among surfaces that fill the beam, the weakest wall is stronger than the strongest wood.
            weakest = found["return_energy"][self.on("North wall", here)].min()
            self.assertGreater(weakest, found["return_energy"][self.on("Door", here)].max(), low)

    def test_the_middle_of_the_door_is_brighter_than_its_sides(self):
        at, points = self.found["incidence_angle"], self.found["points"]
        middle = self.on("Door", at < 3, self.pure)
        sides = self.on("Door", abs(points[:, 1]) > 0.35, self.pure)
        for energy in ("return_energy", "energy"):
            self.assertGreater(self.found[energy][middle].min(), 1.25 * self.found[energy][sides].max(), energy)
        # It is the specular lobe that does it: there wood is even stronger than the wall would be by its diffuse part.
        self.assertGreater(self.median(middle), PULSE * 0.146)

    def test_boundaries_of_materials_are_clear(self):
        # Echoes two steps apart, so that the beam on the boundary may lie between them, at ranges of at most 4 m.
        found = self.found
        of = {(round(found["azimuth"][i]), round(100 * found["vertical_angle"][i])): i
              for i in np.flatnonzero(self.pure)}
        ratios = {}
        for (azimuth, elevation), i in of.items():
            for there in (((azimuth + 400) % 36000, elevation), (azimuth, elevation + 400)):
                k = of.get(there)
                if k is not None and found["distance_m"][i] < 4 and abs(
                        found["distance_m"][i] - found["distance_m"][k]) < 0.5:
                    both = frozenset(int(found["material_id"][j]) for j in (i, k))
                    energies = sorted(found["return_energy"][[i, k]])
                    ratios.setdefault(both, []).append(energies[1] / energies[0])
        for material in (WALL, GLASS, WOOD):
            self.assertLess(np.median(ratios[frozenset([material])]), 1.06, material)
        for one, other, least, pairs in ((WALL, GLASS, 4, 40), (WOOD, GLASS, 6.6, 15), (WALL, WOOD, 1.29, 20)):
            mine = ratios[frozenset([one, other])]
            self.assertGreater(len(mine), pairs)
            self.assertGreater(min(mine), least, (one, other))

    def test_hydrant_cabinet_and_window_stand_out(self):
        wall = self.on("Near end", self.pure)
        for name in ("Hydrant cabinet", "Window of the door"):
            strongest = self.found["energy"][self.on(name, self.pure)].max()
            self.assertLess(strongest, 0.3 * self.found["energy"][wall].min())

    def test_handrail_is_seen(self):
        metal = self.found["material_id"] == METAL
        self.assertGreater(self.on("Handrail", metal).sum(), 5)
        self.assertGreater((metal & (self.found["object_id"] != self.names.index("Handrail"))).sum(), 1)  # posts

    def test_bulletin_board_is_weaker_than_the_wall_around_it(self):
        for column in np.unique(self.found["azimuth"][self.on("Bulletin board", self.pure)]):
            here = (self.found["azimuth"] == column) & self.pure
            board = here & (self.found["object_id"] == self.names.index("Bulletin board"))
            wall = here & (self.found["object_id"] == self.names.index("North wall"))
            if board.any() and wall.any():
                self.assertLess(3 * self.found["energy"][board].max(), self.found["energy"][wall].min(), column)

    def test_wall_echoes_fade_and_vanish(self):
        level = abs(self.found["vertical_angle"]) < 2
        wall = self.on("North wall", level, self.pure, self.found["points"][:, 0] > 3.3)
        order = np.argsort(self.found["distance_m"][wall])
        ranges, energy = (self.found[k][wall][order] for k in ("distance_m", "energy"))
        self.assertGreater(len(np.unique(ranges.round(1))), 6)
        # Down the corridor: no later echo is stronger than one 2 m before, and the last is just above the limit.
        for r, e in zip(ranges, energy):
            self.assertTrue((energy[ranges < r - 2] > e).all(), r)
        self.assertLess(energy[-1], 1.5 * LOW)
        self.assertTrue(11 < ranges[-1] < 13)
        # Beyond, the wall is met but not perceived.
        report = self.lidar.GetOutput(1).GetPointData()
        azimuth = 90 - self.found["azimuth"] / 100
        self.assertFalse((level & (azimuth > 3) & (azimuth < 5)).any())
        status, ids = (et.vtk_to_numpy(report.GetArray(k)) for k in ("status", "beam_id"))
        beyond = np.isin(ids, [43 * 16 + 7, 43 * 16 + 8])  # azimuth 86 degrees, elevations -1 and 1
        self.assertEqual(set(status[beyond]), {2})

    def test_the_last_wall_echo_by_finer_scans(self):
        # Where a wall 1.2 m aside vanishes, with steps of 0.1 degrees: 12.2 m for an infinite number of rays.
        sensor = al.Sensor("CorridorC16", position=corridor_scene.LIDAR, channel_elevations=[0], azimuth_range=(70, 89),
                           azimuth_step=0.1)
        found = al.Scan(al.Scene(self.scene), sensor, attenuation_coefficient=corridor_scene.HAZE,
                        rays_per_beam=2000).echoes
        wall = found["object_id"] == self.names.index("North wall")
        self.assertAlmostEqual(found["distance_m"][wall].max(), 12.2, delta=0.5)

    def test_numbers_of_the_page(self):
        et.assert_documented(self, et.read_table(self.folder + "/table.md"), "corridor")
