# SPDX-License-Identifier: BSD-3-Clause
"""Setters of the echo filter that are gone still work for one version: each warns once and says what to do instead."""
import unittest

from avianlidar import vtkAvianLidar as al
from echotools import CELLS, RAYS, Messages, assert_same_bits, scan, town


class DeprecatedSettings(unittest.TestCase):
    def test_plane_integration_chooses_the_beam_samples(self):
        for on, samples, word in ((False, RAYS, "Rays"), (True, CELLS, "Cells")):
            echo = al.vtkAvianLidarEchoFilter()
            echo.SetBeamSamples(CELLS + RAYS - samples)
            heard = Messages(echo)
            echo.SetPlaneIntegration(on)
            self.assertEqual(echo.GetBeamSamples(), samples)
            self.assertEqual((len(heard.warnings), heard.errors), (1, []))
            self.assertIn(f"use SetBeamSamplesTo{word} instead", heard.warnings[0])
            getattr(echo, "PlaneIntegration" + ("On" if on else "Off"))()
            self.assertEqual((echo.GetBeamSamples(), len(heard.warnings)), (samples, 2))

    def test_no_tree_is_embedded(self):
        tree = al.vtkAvianLidarCollisionTree()
        heard = Messages(tree)
        tree.EmbedTreeOn()
        self.assertEqual((len(heard.warnings), heard.errors), (1, []))
        self.assertRegex(heard.warnings[0], "SetEmbedTree is deprecated and has no effect: .*file")

    def test_the_others_change_nothing(self):
        surfaces = town(count=12)
        for name, value, word in (("RefineNearLimit", False, "RaysPerBeam"), ("TargetRelativeError", 0.02, "RaysPerBeam"),
                                  ("SmallTargets", False, "BeamSamples")):
            with self.subTest(name):
                usual, echo = scan(surfaces), scan(surfaces)
                heard = Messages(echo)
                getattr(echo, "Set" + name)(value)
                self.assertEqual(len(heard.warnings), 1)
                self.assertRegex(heard.warnings[0], rf"Set{name} is deprecated and has no effect: .*{word}")
                for one in (usual, echo):
                    one.Update()
                self.assertGreater(echo.GetOutput().GetNumberOfPoints(), 20)
                assert_same_bits(usual.GetOutput(), echo.GetOutput())
                self.assertEqual(heard.errors, [])


if __name__ == "__main__":
    unittest.main()
