# SPDX-License-Identifier: BSD-3-Clause
"""NumPy arrays of the helpers share and keep VTK's memory; errors, warnings, progress and Ctrl-C are Python's."""
import gc
import os
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings
import weakref

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
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
        echoes = scan.echoes
        output = scan.algorithm.GetOutput()
        for name in echoes:
            self.assertEqual(address(echoes[name]), address(vtk_to_numpy(output.GetPointData().GetArray(name))), name)
            self.assertEqual(address(echoes[name]), address(scan[name]))
        self.assertEqual(address(echoes.points), address(vtk_to_numpy(output.GetPoints().GetData())))
        beams = scan.sensor.beams
        plain = vtk_to_numpy(scan.sensor.algorithm.GetOutput().GetPointData().GetArray("direction"))
        self.assertEqual(address(beams["direction"]), address(plain))

    def test_arrays_cannot_be_written_to(self):
        scan = a_scan()
        for array in (scan["energy"], scan.echoes.points, scan.range_image()["distance_m"]):
            with self.assertRaisesRegex(ValueError, "read-only"):
                array[0] = 1
        copy = scan["energy"].copy()
        copy[0] = 1

    def test_arrays_outlive_everything(self):
        scan = a_scan()
        energy, points, expected = scan["energy"], scan.echoes.points, scan["energy"].copy()
        image = scan.range_image()["distance_m"]
        finite = image[np.isfinite(image)].copy()
        places = points.copy()
        filters = [weakref.ref(thing) for thing in (scan.algorithm, scan.sensor.algorithm, scan.scene.tree)]
        array = weakref.ref(scan.algorithm.GetOutput().GetPointData().GetArray("energy"))
        del scan
        gc.collect()
        self.assertEqual([ref() for ref in filters], [None] * 3)  # nothing else is kept
        self.assertIsNotNone(array())
        noise = [np.full(len(energy), i, dtype=float) for i in range(100)]  # would take freed memory
        self.assertTrue(np.array_equal(energy, expected) and np.array_equal(points, places))
        self.assertTrue(np.array_equal(image[np.isfinite(image)], finite))
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


    def test_visibility_is_air(self):
        clear, haze = a_scan(visibility=23e3), a_scan(visibility=5e3)
        # Kruse and Kim: 8.9e-5 1/m at 23 km and 905 nm.
        self.assertAlmostEqual(float(clear.echoes.fields["attenuation_coefficient"]), 8.9e-5, delta=1e-6)
        self.assertGreater(float(haze.echoes.fields["attenuation_coefficient"]), 4e-4)
        self.assertLess(haze["energy"].max(), clear["energy"].max())
        same_air = a_scan(attenuation_coefficient=float(clear.echoes.fields["attenuation_coefficient"]))
        self.assertTrue(same(clear.echoes, same_air.echoes))
        for wrong in (-1.0, float("nan"), float("inf"), 1e-40):
            clear.visibility = wrong
            with self.assertRaisesRegex(al.Error, "Visibility is .*, expected 0, or up to 1e9 m"):
                clear.update()
        clear.visibility = 23e3
        self.assertTrue(same(clear.echoes, same_air.echoes))


class Messages(unittest.TestCase):
    def test_errors_are_exceptions(self):
        scan = a_scan()
        scan.sensor.pulse_energy = -1
        for _ in range(2):  # as long as it is so
            with self.assertRaisesRegex(al.Error, r"\AvtkAvianLidarBeamSource: .*PulseEnergy is -1, expected .* J\.\Z"):
                scan.update()
        scan.sensor.pulse_energy = 3.6e-4
        self.assertTrue(same(scan.echoes, a_scan().echoes))
        scan.rays_per_beam = 0
        with self.assertRaisesRegex(al.Error, "^vtkAvianLidarEchoFilter: .*RaysPerBeam"):
            scan["energy"]
        with self.assertRaises(KeyError):
            a_scan()["enrgy"]
        with self.assertRaisesRegex(TypeError, "vtkPointSet"):
            al.Cloud(vtkImageData())

    def test_a_sensor_that_fails_leaves_no_echoes(self):
        """Not those of the scan before, however often they are asked for; mended, it scans as it did."""
        scan = a_scan()
        before = scan.echoes
        for position in ((1e31, 0, 0), (float("nan"), 0, 0)):
            scan.sensor.position = position
            for _ in range(2):
                for ask in (lambda: scan.echoes, lambda: scan.report, lambda: scan["energy"], scan.range_image):
                    with self.assertRaisesRegex(al.Error, "^vtkAvianLidarBeamSource: .*Position"):
                        ask()
        scan.sensor.position = (0, 0, 0)
        self.assertTrue(same(scan.echoes, before))

    def test_nothing_is_printed(self):
        code = ("import avianlidar as al\n"
                "try:\n    al.Scan(al.Scene(), al.Sensor(azimuth_step=-1)).update()\n"
                "except al.Error as error:\n    print('caught', error)\n")
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertRegex(result.stdout, "^caught vtkAvianLidarBeamSource: .*AzimuthStep")
        self.assertEqual(result.stderr, "")

    def test_errors_where_the_display_of_warnings_is_off(self):
        """VTK then sends no events: what is known is that it failed."""
        self.addCleanup(vtkObject.GlobalWarningDisplayOn)
        file = os.path.join(tempfile.mkdtemp(), "scene.lidarscene.json")
        vtkObject.GlobalWarningDisplayOff()
        for call in (lambda: al.Sensor(pulse_energy=-1).beams, lambda: a_scan(rays_per_beam=0).echoes,
                     lambda: al.load_scene(file), lambda: a_scan(attenuation_coefficient=-1).save(file + ".csv")):
            for _ in range(2):
                with self.assertRaisesRegex(al.Error, r"vtkAvianLidar\w+: failed, and VTK's messages are off"):
                    call()
        self.assertFalse(os.path.exists(file + ".csv"))

    def test_a_failure_without_a_word(self):
        class Mute(VTKPythonAlgorithmBase):
            result = 0

            def __init__(self):
                super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkPolyData")

            def RequestData(self, *_):
                return self.result

        mute = Mute()
        for _ in range(2):
            with self.assertRaisesRegex(al.Error, "vtkPythonAlgorithm: failed"):
                al.Scene(mute)
        mute.AddObserver("StartEvent", lambda *_: vtkObject.GlobalWarningDisplayOff())  # no executive says it either
        self.addCleanup(vtkObject.GlobalWarningDisplayOn)
        for _ in range(2):
            with self.assertRaisesRegex(al.Error, "vtkPythonAlgorithm: failed"):
                al.Scene(mute)
        Mute.result = 1
        self.assertEqual(al.Scene(mute).surfaces.GetNumberOfBlocks(), 1)

    def test_warnings_are_warnings(self):
        cube = vtkCubeSource()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            al.Scan(al.Scene(cube), al.Sensor(azimuth_step=10)).update()
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

    def test_interrupt(self):
        before = signal.getsignal(signal.SIGINT)
        heard = []

        def interrupt(share, name):
            if name == "vtkAvianLidarEchoFilter":
                heard.append(share)
                if share > 0.02:
                    os.kill(os.getpid(), signal.SIGINT)

        self.scan.progress = interrupt
        with self.assertRaises(KeyboardInterrupt):
            self.scan.update()
        self.assertLess(heard[-1], 0.5)  # long before its end
        self.assertEqual(self.scan.algorithm.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(signal.getsignal(signal.SIGINT), before)
        self.assert_goes_on()

    def signalled(self, number, handler):
        """The scan with a handler that gets a signal while VTK works. The handler stays who handles it."""
        before = signal.signal(number, handler)
        sender = subprocess.Popen(["sh", "-c", f"sleep 0.1; kill -{int(number)} {os.getpid()}"])
        try:
            self.scan.update()
        finally:
            sender.wait()
            self.assertIs(signal.getsignal(number), handler)
            signal.signal(number, before)

    def test_signals_whose_handler_raises(self):
        shares = []
        self.scan.set(preset="Custom", rays_per_beam=20000)
        self.scan.progress = lambda share, name: shares.append(share)
        for number in (signal.SIGTERM, signal.SIGALRM, signal.SIGINT):
            for kind in (TimeoutError, SystemExit, KeyboardInterrupt):
                def handler(*_, kind=kind):
                    raise kind("enough")

                with self.subTest(f"{number}, {kind}"):
                    self.scan.seed += 1
                    with self.assertRaisesRegex(kind, "enough"):
                        self.signalled(number, handler)
                    self.assertLess(shares[-1], 0.9)
                    self.assertEqual(self.scan.algorithm.GetOutput().GetNumberOfPoints(), 0)
        self.assert_goes_on()

    def test_signals_whose_handler_returns(self):
        """The scan goes on."""
        self.scan.set(preset="Custom", rays_per_beam=2000)
        for number in (signal.SIGALRM, signal.SIGINT):
            heard = []
            self.scan.seed += 1
            self.signalled(number, lambda number, _, heard=heard: heard.append(number))
            self.assertEqual(heard, [number])
            self.assertGreater(self.scan.algorithm.GetOutput().GetNumberOfPoints(), 100)

    def test_many_signals(self):
        """At any place of the helper's code: nothing is printed, and the handler is who it was."""
        code = ("import signal, avianlidar as al\n"
                "from echotools import town\n"
                "class Enough(Exception): pass\n"
                "def stop(*_): raise Enough\n"
                "signal.signal(signal.SIGALRM, stop)\n"
                "scan = al.Scan(al.Scene(town()), al.Sensor(azimuth_step=1), preset='Draft', beam_samples='rays')\n"
                "scan.update()\n"
                "ends = 0\n"
                "for i in range(300):\n"
                "    try:\n"
                "        signal.setitimer(signal.ITIMER_REAL, 1e-6 + 1e-5 * i)\n"
                "        scan.seed = i\n"
                "        scan.update()\n"
                "        signal.setitimer(signal.ITIMER_REAL, 0)\n"
                "    except Enough:\n"
                "        ends += 1\n"
                "signal.signal(signal.SIGALRM, signal.SIG_IGN)\n"
                "print(ends, signal.getsignal(signal.SIGINT) is signal.default_int_handler)\n")
        path = os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), os.environ.get("PYTHONPATH", "")])
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=200,
                                env={**os.environ, "PYTHONPATH": path})
        self.assertEqual(result.stderr, "")
        self.assertEqual(result.stdout, "300 True\n")

    def test_other_threads_leave_signals_alone(self):
        results = []
        thread = threading.Thread(target=lambda: results.append(self.scan.set(preset="Draft").echoes.number_of_points))
        thread.start()
        thread.join()
        self.assertGreater(results[0], 100)


class Imports(unittest.TestCase):
    def test_neither_matplotlib_nor_rendering(self):
        code = ("import sys, avianlidar\n"
                "print([m for m in sys.modules if m.startswith('matplotlib') or 'Rendering' in m or m == 'vtk'])")
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual(result.stdout.strip(), "[]")


if __name__ == "__main__":
    unittest.main()
