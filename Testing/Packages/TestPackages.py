# SPDX-License-Identifier: BSD-3-Clause
"""The Debian packages that cpack makes of the build tree: fields, every file in its place and in one package, nothing
of the machine that built them, no error of lintian. What comes out lies ready for the tests that install it."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

BUILD = pathlib.Path(os.environ["AVIANLIDAR_BUILD_DIR"])
SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
GIVEN = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]) / "Packages"  # to overlay.sh
RELEASE = re.search(r"project\(AvianLidar\s+VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text("utf-8"))[1]
VERSION = f"{RELEASE}-1"
PARAVIEW = next(BUILD.glob("lib/paraview-*")).name
PLUGINS, PACKAGE = f"usr/lib/{PARAVIEW}/plugins/", r"usr/lib/python3/dist-packages/avianlidar/"
DOCUMENTS = r"usr/share/doc/[\w-]+/(copyright|changelog\.gz|changelog\.Debian\.gz)"
# Fields of each package, and the places where its files may be.
PACKAGES = {"avian-lidar": ({"Section": "science", "Recommends": "python3-avianlidar",
                             "Depends": r".*libassimp5 .*libgdal3\d .*libqt(5widgets5|6widgets6) .*paraview \(>= "
                                        r"(5\.\d+).*paraview \(<< \2"},
                            [r"usr/(bin/paraview\.conf|share/paraview/plugins)",
                             rf"usr/lib/libvtkAvianLidar\.so\.({RELEASE}|{RELEASE.rpartition('.')[0]})",
                             r"usr/lib/avianlidar/mesh-reader", PLUGINS + r"avianlidar\.plugins\.xml",
                             PLUGINS + r"AvianLidarPlugin/(AvianLidarPlugin\.so|[A-Z][a-z]+/\w[\w.-]+)"]),
            "python3-avianlidar": (
                {"Section": "python", "Recommends": r".*matplotlib.*gdal.*jinja2.*jsonschema.*scipy.*pandas",
                 "Depends": r"avian-lidar \(= \S+\), python3 \(>= 3.*python3 \(<< 3.*python3-numpy, python3-paraview, "
                            r"python3-tqdm, "},
                [r"usr/bin/avianlidar", PACKAGE + r"(apps/(\w+/)?)?[\w.]+",
                 PACKAGE + r"scene/(LICENSE-ODbL\.md|hongqiao\.(geojson|lidarscene\.json))",
                    r"usr/share/man/man1/avianlidar\.1\.gz", r"usr/share/bash-completion/completions/avianlidar",
                    r"usr/share/zsh/vendor-completions/_avianlidar"]),
            "libavian-lidar-dev": (
                {"Section": "libdevel", "Depends": r"avian-lidar \(= \S+\), .*paraview-dev"},
                [r"usr/include/avianlidar/\w+\.h", r"usr/lib/cmake/AvianLidar/\S+",
                 r"usr/lib/libvtkAvianLidar(\.so|CS\.a)", r"usr/lib/vtk/hierarchy/AvianLidar/\S+"]),
            "avian-lidar-doc": (
                {"Section": "doc", "Architecture": "all"},
                [r"usr/share/doc/avian-lidar-doc/((README|CONTRIBUTING)\.md|(Documentation|Examples)/\S+)"])}


def output(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(GIVEN, ignore_errors=True)
        (GIVEN / "unpacked").mkdir(parents=True)
        cls.folder = GIVEN / "first"
        subprocess.run(["cpack", "-B", cls.folder], cwd=BUILD, check=True, stdout=subprocess.DEVNULL)
        shutil.rmtree(cls.folder / "_CPack_Packages")
        cls.files = {file.name.split("_")[0]: file for file in cls.folder.iterdir()}
        cls.unpacked = {name: GIVEN / "unpacked" / name for name in cls.files}
        for name, file in cls.files.items():
            output("dpkg-deb", "--extract", file, cls.unpacked[name])

    def test_fields(self):
        self.assertEqual(set(self.files), set(PACKAGES))
        for name, (fields, _) in PACKAGES.items():
            with self.subTest(name):
                self.assertRegex(self.files[name].name, rf"^{name}_{VERSION}_\w+\.deb$")
                control = output("dpkg-deb", "--field", self.files[name])
                found = dict(re.findall(r"^([\w-]+): (.*)$", control, re.M))
                for field, wanted in {**fields, "Version": VERSION, "Source": "avian-lidar"}.items():
                    self.assertRegex(found[field], f"^{wanted}", field)
                self.assertGreater(len(re.findall(r"^ \S", control, re.M)), 2, "description")

    def test_every_file_is_in_its_place(self):
        seen = {}
        for name, (_, places) in PACKAGES.items():
            with self.subTest(name):
                listed = output("dpkg-deb", "--contents", self.files[name]).splitlines()
                files = [line.split()[5][2:] for line in listed if not line.startswith("d")]
                wrong = [file for file in files if not any(re.fullmatch(place, file) for place in [*places, DOCUMENTS])]
                self.assertEqual(wrong, [])
                self.assertEqual(sum(re.fullmatch(DOCUMENTS, file) is not None for file in files), 3)
                self.assertEqual({line.split()[1] for line in listed}, {"root/root"})
                seen[name] = set(files)
        self.assertEqual(sum(map(len, seen.values())), len(set().union(*seen.values())))
        # What `cmake --install` puts below a prefix is in one of them.
        prefix = GIVEN / "prefix"
        output("cmake", "--install", BUILD, "--prefix", prefix)
        installed = {"usr/" + str(file.relative_to(prefix)) for file in prefix.rglob("*") if not file.is_dir()}
        self.assertEqual(installed - set().union(*seen.values()), set())
        shutil.rmtree(prefix)

    def test_nothing_of_the_machine_that_built_them(self):
        for name, folder in self.unpacked.items():
            with self.subTest(name):
                for one in folder.rglob("*"):
                    if one.is_file():
                        self.assertNotIn(bytes(BUILD), one.read_bytes(), one)
                    if ".so" in one.name and not one.is_symlink():
                        self.assertIn(", stripped", output("file", one))
                        self.assertNotRegex(output("readelf", "--dynamic", one), r"R(UN)?PATH.*\[(?!\$ORIGIN)")

    def test_paraview_loads_the_plugin(self):
        """A copy of pvpython beside the unpacked paraview.conf does what the installed one will. Debian 13's ParaView
        reads the list that its own paraview.conf names."""
        folder = self.unpacked["avian-lidar"] / "usr"
        listed = folder / "share" / "paraview" / "plugins"
        if listed.exists():
            (conf,) = pathlib.Path("/usr/lib").glob(f"*/{PARAVIEW}/paraview.conf")
            self.assertIn("/usr/share/paraview/plugins", conf.read_text().split())
            self.assertIn(f'auto_load="1" filename="/{PLUGINS}AvianLidarPlugin/AvianLidarPlugin.so"',
                          listed.read_text())
            return
        program = shutil.copy("/usr/bin/pvpython", folder / "bin")
        found = output(program, "-c", """if True:
            from paraview import servermanager, simple
            manager = servermanager.vtkSMProxyManager.GetProxyManager().GetPluginManager()
            plugins = manager.GetLocalInformation()
            for i in range(plugins.GetNumberOfPlugins()):
                if plugins.GetPluginLoaded(i):
                    print(plugins.GetPluginFileName(i))""").split()
        plugin = folder / "lib" / PARAVIEW / "plugins/AvianLidarPlugin/AvianLidarPlugin.so"
        self.assertIn(str(plugin), [os.path.normpath(name) for name in found])

    def test_lintian_finds_no_error(self):
        result = subprocess.run(["lintian", "--allow-root", "--fail-on", "error", *self.files.values()],
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_ready_to_be_installed(self):
        """The same packages of a later version, for an upgrade, and what installed.sh runs."""
        later = GIVEN / "second"
        later.mkdir()
        for file in self.files.values():
            folder = GIVEN / "later"
            output("dpkg-deb", "--raw-extract", file, folder)
            for control in (folder / "DEBIAN" / "control", folder / "DEBIAN" / "shlibs"):
                if control.exists():
                    control.write_text(control.read_text().replace(VERSION, VERSION + "+later"))
            output("dpkg-deb", "--root-owner-group", "-Znone", "--build", folder, later)
            shutil.rmtree(folder)
        self.assertEqual(len(list(later.iterdir())), len(PACKAGES))
        shutil.copytree(SOURCE / "Examples" / "cxx", GIVEN / "cxx")
        for name in ("installed.sh", "plugin.py"):
            shutil.copy(SOURCE / "Testing" / "Packages" / name, GIVEN)


if __name__ == "__main__":
    unittest.main()
