# SPDX-License-Identifier: BSD-3-Clause
"""NumPy arrays of the helpers share and keep VTK's memory; errors, warnings, progress and Ctrl-C are Python's."""
import gc
import os
import signal
import subprocess
import sys
import tempfile
import unittest
import warnings
import weakref

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersSources import vtkCubeSource

import avianlidar as al
from echotools import town
from helpertools import WALL, address, same


def a_scan(**settings):
    return al.Scan(al.Scene(WALL), al.Sensor(azimuth_step=2), **settings)


class Memory(unittest.TestCase):
    def test_no_copies(self):
        scan = a_scan()
        echoes, output = scan.echoes, scan.algorithm.GetOutput()
        for name in echoes:
            self.assertEqual(address(echoes[name]), address(vtk_to_numpy(output.GetPointData().GetArray(name))), name)
            self.assertEqual(address(echoes[name]), address(scan[name]))
        self.assertEqual(address(echoes.points), address(vtk_to_numpy(output.GetPoints().GetData())))
        for array in (scan["energy"], echoes.points, scan.range_image()["distance_m"], scan.sensor.beams["direction"]):
            with self.assertRaisesRegex(ValueError, "read-only"):
                array[0] = 1

    def test_arrays_outlive_everything(self):
        scan = a_scan()
        energy, points, expected = scan["energy"], scan.echoes.points, scan["energy"].copy()
        places = points.copy()
        filters = [weakref.ref(thing) for thing in (scan.algorithm, scan.sensor.algorithm, scan.scene.tree)]
        array = weakref.ref(scan.algorithm.GetOutput().GetPointData().GetArray("energy"))
        del scan
        gc.collect()
        self.assertEqual([ref() for ref in filters], [None] * 3)  # nothing else is kept
        self.assertIsNotNone(array())
        noise = [np.full(len(energy), i, dtype=float) for i in range(100)]  # would take freed memory
        self.assertTrue(np.array_equal(energy, expected) and np.array_equal(points, places))
        del energy, noise
        gc.collect()
        self.assertIsNone(array())

    def test_clouds_stay_as_they_are(self):
        scan = a_scan()
        first, report = scan.echoes, scan.report
        copies = {name: first[name].copy() for name in first}, {name: report[name].copy() for name in report}
        for change in ({"seed": 3}, {"attenuation_coefficient": 3e-4}, {"return_mode": "First"}, {"rays_per_beam": 50}):
            scan.set(**change).update()
            for cloud, copy in zip((first, report), copies):
                for name in copy:
                    self.assertEqual(cloud[name].tobytes(), copy[name].tobytes(), (change, name))


class Messages(unittest.TestCase):
    def test_errors_are_exceptions(self):
        """As long as it is so, whatever is asked for, and no echoes of the scan before; mended, it scans as it did."""
        scan = a_scan()
        before = scan.echoes
        for name, value, good in (("pulse_energy", -1, 3.6e-4), ("position", (float("nan"), 0, 0), (0, 0, 0))):
            setattr(scan.sensor, name, value)
            ways = (scan.update, lambda: scan.echoes, lambda: scan.report, lambda: scan["energy"], scan.range_image)
            for ask in ways * 2:
                with self.assertRaisesRegex(al.Error, r"\AvtkAvianLidarBeamSource: .*" + name.title().replace("_", "")):
                    ask()
            setattr(scan.sensor, name, good)
            self.assertTrue(same(scan.echoes, before))
        scan.rays_per_beam = 0
        with self.assertRaisesRegex(al.Error, "^vtkAvianLidarEchoFilter: .*RaysPerBeam"):
            scan["energy"]
        with self.assertRaisesRegex(TypeError, "vtkPointSet"):
            al.Cloud(vtkImageData())

    def test_nothing_is_printed(self):
        code = ("import sys, avianlidar as al\n"
                "print([m for m in sys.modules if m.startswith('matplotlib') or 'Rendering' in m or m == 'vtk'])\n"
                "try:\n    al.Scan(al.Scene(), al.Sensor(azimuth_step=-1)).update()\n"
                "except al.Error as error:\n    print('caught', error)\n")
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertRegex(result.stdout, r"^\[\]\ncaught vtkAvianLidarBeamSource: .*AzimuthStep")
        self.assertEqual(result.stderr, "")

    def test_errors_where_the_display_of_warnings_is_off(self):
        """VTK then sends no events: what is known is that it failed."""
        self.addCleanup(vtkObject.GlobalWarningDisplayOn)
        file = os.path.join(tempfile.mkdtemp(), "scene.lidarscene.json")
        vtkObject.GlobalWarningDisplayOff()
        for call in (lambda: al.Sensor(pulse_energy=-1).beams, lambda: a_scan(rays_per_beam=0).echoes,
                     lambda: al.load_scene(file), lambda: a_scan(attenuation_coefficient=-1).save(file + ".csv")):
            with self.assertRaisesRegex(al.Error, r"vtkAvianLidar\w+: failed, and VTK's messages are off"):
                call()
        self.assertFalse(os.path.exists(file + ".csv"))

    def test_warnings_are_warnings(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            al.Scan(al.Scene(vtkCubeSource()), al.Sensor(azimuth_step=10, position=(0, -9, 0))).update()
        self.assertEqual(len(caught), 1, [str(w.message) for w in caught])
        self.assertRegex(str(caught[0].message), "^vtkAvianLidarCollisionTree: .*taken as Wall")
        self.assertEqual(caught[0].category, RuntimeWarning)
        self.assertEqual(os.path.basename(caught[0].filename), "TestHelperPipeline.py")  # where it was called
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            a_scan().update()  # arrays are a wall without a word


class Stopping(unittest.TestCase):
    def setUp(self):
        # By rays, as there has to be something to stop: integrated, this town is done in a few hundredths of a second.
        self.scan = al.Scan(al.Scene(town()), al.Sensor(azimuth_step=1), preset="Reference", beam_samples="rays")

    def assert_goes_on(self):
        """After a stop the scan is what it would have been."""
        self.scan.progress = None
        self.scan.preset = "Draft"
        fresh = al.Scan(al.Scene(town()), al.Sensor(azimuth_step=1), preset="Draft", seed=self.scan.seed,
                        beam_samples="rays")
        self.assertTrue(same(self.scan.echoes, fresh.echoes))
        self.assertGreater(fresh.echoes.number_of_points, 100)

    def test_progress(self):
        heard = []
        self.scan.set(preset="Draft")
        self.scan.progress = lambda share, name: heard.append((share, name))
        self.scan.update()
        shares = [share for share, name in heard if name == "vtkAvianLidarEchoFilter"]
        self.assertEqual(shares, sorted(shares))
        self.assertEqual((shares[0], shares[-1]), (0, 1))
        self.assertIn("vtkAvianLidarCollisionTree", [name for _, name in heard])
        heard.clear()
        self.scan.update()  # up to date
        self.assertEqual(heard, [])

    def test_exceptions_of_progress_are_passed_on(self):
        for where in ("vtkAvianLidarBeamSource", "vtkAvianLidarCollisionTree", "vtkAvianLidarEchoFilter"):
            def stop(share, name, where=where):
                if name == where:
                    raise LookupError(f"stop at {name}")

            with self.subTest(where):
                self.setUp()
                self.scan.progress = stop
                with self.assertRaisesRegex(LookupError, where):
                    self.scan.update()
                self.assert_goes_on()

    def signalled(self, number, handler):
        """The scan with a handler that gets a signal when VTK works. The handler stays who handles it."""
        before, shares, sent = signal.signal(number, handler), [], []

        def send(share, name):
            shares.append(share)
            if name == "vtkAvianLidarEchoFilter" and share > 0.02 and not sent:
                sent.append(share)
                os.kill(os.getpid(), number)

        self.scan.progress = send
        self.scan.seed += 1
        try:
            self.scan.update()
        finally:
            self.assertIs(signal.getsignal(number), handler)
            signal.signal(number, before)
            self.share = shares[-1]

    def test_signals_whose_handler_raises(self):
        def ends(kind):
            def handler(*_):
                raise kind("enough")
            return handler

        for number, kind, handler in ((signal.SIGINT, KeyboardInterrupt, signal.default_int_handler),
                                      (signal.SIGINT, LookupError, None),
                                      (signal.SIGTERM, SystemExit, None), (signal.SIGALRM, TimeoutError, None)):
            with self.subTest(f"{number}, {kind}"):
                with self.assertRaises(kind):
                    self.signalled(number, handler or ends(kind))
                self.assertLess(self.share, 0.5)  # long before its end
                self.assertEqual(self.scan.algorithm.GetOutput().GetNumberOfPoints(), 0)
        self.assert_goes_on()

    def test_signals_whose_handler_returns(self):
        """The scan goes on."""
        self.scan.set(preset="Draft")
        for number in (signal.SIGALRM, signal.SIGINT):
            heard = []
            self.signalled(number, lambda number, _, heard=heard: heard.append(number))
            self.assertEqual(heard, [number])
            self.assertGreater(self.scan.algorithm.GetOutput().GetNumberOfPoints(), 100)
