# SPDX-License-Identifier: BSD-3-Clause
"""An error on one rank ends the execution on all, with its message and without a hang; so does a wish to abort."""

import json
import os

import vtk

from paralleltools import LAST, RANK, RANKS, assert_same, exchange, in_order, joined, main, point_arrays, total, update
import echotools
from avianlidar import vtkAvianLidar as al

TOWN = echotools.town(3, 12)
SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}


def check_failed(echo, words, algorithm=None):
    """Rank LAST says what is wrong; rank 0 says it too, and of whom; nobody has any output."""
    messages = echotools.Messages(echo, *([algorithm] if algorithm else []))
    update(echo)
    assert [echo.GetOutput(port).GetNumberOfPoints() for port in (0, 1)] == [0, 0]
    heard = exchange("\n".join(messages.errors))
    assert words in heard[LAST], heard
    assert words in heard[0] and (LAST == 0 or f"Rank {LAST}" in heard[0]), heard
    assert all(not text for text in heard[1:LAST]), heard


def check_good(echo):
    expected = echotools.scan(TOWN, **SETTINGS)
    expected.Update()
    assert_same(joined(update(echo).GetOutput()), in_order(point_arrays(expected.GetOutput())))


def mine(good, bad):
    return bad if RANK == LAST else good


def mend(echo, port, data):
    """Good data on all ranks, which all must execute on."""
    echo.SetInputData(port, data)
    echo.Modified()
    check_good(echo)


def with_bad_array():
    bad = echotools.box((50, 0, 0), (5, 5, 5), "Metal")
    bad.GetCellData().RemoveArray("ks")
    return bad


def with_bad_point():
    bad = echotools.box((50, 0, 0), (5, 5, 5), "Metal")
    bad.GetPoints().SetPoint(3, float("nan"), 0, 0)
    return bad


def test_bad_surfaces():
    for bad, words in ((with_bad_array(), "only some are there"), (vtk.vtkImageData(), "not vtkPolyData")):
        blocks = vtk.vtkMultiBlockDataSet()
        blocks.ShallowCopy(TOWN)
        blocks.SetBlock(3, bad)
        echo = echotools.scan(mine(TOWN, blocks), **SETTINGS)
        check_failed(echo, words)
        mend(echo, 1, TOWN)


def test_bad_coordinates():
    """Found when the surfaces have reached everybody: everybody has the error."""
    echo = echotools.scan(mine(vtk.vtkPolyData(), with_bad_point()), **SETTINGS)
    messages = echotools.Messages(echo)
    update(echo)
    assert all("not finite" in text for text in exchange("\n".join(messages.errors)))
    mend(echo, 1, TOWN)


def test_block_of_2_gib():
    """More than VTK sends at once: an error on all ranks that names the block."""
    large = echotools.box((50, 0, 0), (5, 5, 5), "Metal")
    if RANK == LAST:
        large.GetPoints().GetData().Resize(90_000_000)  # 24 bytes each; never written, so they take no memory
        large.GetPoints().GetData().SetNumberOfTuples(90_000_000)
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.ShallowCopy(TOWN)
    blocks.SetBlock(3, mine(None, large))
    echo = echotools.scan(blocks, **SETTINGS)
    check_failed(echo, "block 'house 3': too large to send")
    mend(echo, 1, TOWN)


def test_bad_surfaces_of_the_tree():
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(mine(vtk.vtkPolyData(), with_bad_array()))
    echo = echotools.scan(tree, **SETTINGS)
    messages = echotools.Messages(tree, echo)
    update(echo)
    heard = exchange("\n".join(messages.errors))
    assert "only some are there" in heard[LAST] and "only some are there" in heard[0], heard
    assert echo.GetOutput().GetNumberOfPoints() == 0
    tree.SetInputData(TOWN)
    echo.Modified()
    check_good(echo)


def test_bad_beams():
    source = echotools.sensor()
    update(source)
    bad = vtk.vtkPolyData()
    bad.DeepCopy(source.GetOutput())
    bad.GetPointData().GetArray("direction").SetTuple3(2, 0, 0, 0)
    echo = echotools.scan(TOWN, mine(source.GetOutput(), bad), **SETTINGS)
    check_failed(echo, "'direction' is zero")
    mend(echo, 0, source.GetOutput())


def test_bad_settings():
    echo = echotools.scan(TOWN, **SETTINGS)
    echo.SetRaysPerBeam(mine(20, 0))
    check_failed(echo, "0, expected")
    echo.SetRaysPerBeam(20)
    echo.Modified()
    check_good(echo)


def test_settings_that_differ():
    """Each rank's are good, but echoes of both would be mixed."""
    for name, value in (("RaysPerBeam", 30), ("Visibility", 1000.0), ("ReturnMode", 1)):
        echo = echotools.scan(TOWN, **SETTINGS)
        before = getattr(echo, "Get" + name)()
        getattr(echo, "Set" + name)(mine(before, value))
        messages = echotools.Messages(echo)
        update(echo)
        assert [echo.GetOutput(port).GetNumberOfPoints() for port in (0, 1)] == [0, 0]
        for heard in exchange("\n".join(messages.errors)):
            assert name in heard and f"on rank {LAST}, expected the same on all ranks" in heard, (name, heard)
        getattr(echo, "Set" + name)(before)
        echo.Modified()
        check_good(echo)


def test_beams_of_two_sensors():
    source = echotools.sensor()
    source.Update()
    whole = source.GetOutput()
    echo = echotools.scan(TOWN, whole, **SETTINGS)  # every rank has all beams
    messages = echotools.Messages(echo)
    update(echo)
    assert RANKS == 1 or all("twice" in text for text in exchange("\n".join(messages.errors)))
    other = vtk.vtkPolyData()
    update(source)
    other.DeepCopy(source.GetOutput())
    other.GetFieldData().GetArray("pulse_energy").SetValue(0, 1e-4)
    echo.SetInputData(0, mine(source.GetOutput(), other))
    echo.Modified()
    messages.errors.clear()
    update(echo)
    assert RANKS == 1 or all("different sensors" in text for text in exchange("\n".join(messages.errors)))
    mend(echo, 0, source.GetOutput())


def test_missing_file():
    """A reader upstream fails on one rank, so that rank's filter would not even be asked."""
    reader = al.vtkAvianLidarSceneReader()
    scene = os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Examples", "airport", "scene", "hongqiao.lidarscene.json")
    reader.SetFileName(mine(scene, "missing.lidarscene.json"))
    for pipeline in ("plain", "tree"):
        surfaces = reader
        if pipeline == "tree":
            surfaces = al.vtkAvianLidarCollisionTree()
            surfaces.SetInputConnection(reader.GetOutputPort())
        echo = echotools.scan(surfaces, **SETTINGS)
        messages = echotools.Messages(reader, surfaces, echo)
        update(echo)
        heard = exchange("\n".join(messages.errors))
        assert "missing.lidarscene.json" in heard[LAST], heard
        assert RANKS == 1 or "upstream" in heard[0], heard
        assert echo.GetOutput().GetNumberOfPoints() == 0
        reader.Modified()
    reader.SetFileName(scene)
    reader.Modified()
    assert len(joined(update(echo).GetOutput())["beam_id"]) > 0


def test_missing_file_of_vtk():
    """A reader of VTK executes on rank 0 alone and returns 0 there: the others would wait in an exchange."""
    reader = vtk.vtkSTLReader()
    reader.SetFileName("missing.stl")
    echo = echotools.scan(reader, **SETTINGS)
    messages = echotools.Messages(reader, echo)
    for words in ("upstream" if RANKS > 1 else "", "its producer failed"):
        update(echo)
        assert words in exchange("\n".join(messages.errors))[0], messages.errors
        assert echo.GetOutput().GetNumberOfPoints() == 0
        messages.errors.clear()
        echo.Modified()


def error_of(data):
    array = data.GetFieldData().GetAbstractArray("error")
    return array.GetValue(0) if array else ""


def check_error_as_data(algorithm, messages, words):
    """The last rank's error ends the execution on all ranks: empty outputs that say why; said where it is, and on rank 0."""
    update(algorithm)
    for port in range(algorithm.GetNumberOfOutputPorts()):
        data = algorithm.GetOutputDataObject(port)
        assert data.IsA("vtkImageData") or data.GetNumberOfPoints() == 0, data.GetNumberOfPoints()
        assert words in error_of(data), error_of(data)
    heard = exchange("\n".join(messages.errors))
    messages.errors.clear()
    assert words in heard[0] and words in heard[LAST], heard
    assert all(text.count("ERROR:") == 1 for text in heard if text), heard


def test_errors_as_data():
    """As in ParaView: what fails on one rank goes on with an empty output, which is missing on no rank in silence.
    The image is made again on all ranks or on none, also where a rank's part of it is empty."""
    for rows in (4, 1):
        material = al.vtkAvianLidarMaterial()
        material.SetMaterialToCustom()
        material.SetInputData(TOWN)
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputConnection(material.GetOutputPort())
        source = echotools.sensor(RANKS - 1, rows)
        echo = echotools.scan(tree, source, **SETTINGS)
        image = al.vtkAvianLidarRangeImage()
        image.SetInputConnection(0, echo.GetOutputPort())
        image.SetInputConnection(1, source.GetOutputPort())
        consumers = [vtk.vtkDataSetSurfaceFilter(), vtk.vtkImageDataGeometryFilter()]
        for consumer in consumers:
            consumer.SetInputConnection(image.GetOutputPort())
        chain = (material, tree, echo, image)
        for algorithm in chain:
            algorithm.ErrorsAsDataOn()
        said = [echotools.Messages(algorithm) for algorithm in chain]
        for kd in (-1, -2):
            material.SetKd(mine(0.3, kd))
            material.Modified()
            check_error_as_data(image, said[3], "its producer failed: Material: ")
            for algorithm, messages in zip(chain[1:3], said[1:3]):
                check_error_as_data(algorithm, messages, "its producer failed: Material: ")
            # Up to date: nobody waits for anybody, and nothing is said again. Surfaces of images ask for their extent.
            for consumer in (image, *consumers):
                update(consumer)
            assert not any(exchange("".join("".join(messages.errors) for messages in said[1:])))
            material.SetKd(0.3)
            material.Modified()
            update(image)
            assert not error_of(image.GetOutput()) and not error_of(echo.GetOutput())
            assert total(image.GetOutput().GetNumberOfPoints()) >= (RANKS - 1) * rows
            said[0].errors.clear()


def test_damaged_mesh():
    """The first rank alone opens meshes: its error is that of all."""
    file = os.path.join(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"], f"TestRanksErrors-{RANKS}-{RANK}.lidarscene.json")
    mesh = os.path.splitext(file)[0] + ".stl"
    with open(mesh, "w", encoding="utf-8") as stream:
        stream.write("solid nothing")
    with open(file, "w", encoding="utf-8") as stream:
        json.dump({"version": 1, "objects": [{"file": os.path.basename(mesh), "material": "wall"}]}, stream)
    reader = al.vtkAvianLidarSceneReader()
    reader.SetFileName(file)
    echo = echotools.scan(reader, **SETTINGS)
    messages, opened = echotools.Messages(echo), echotools.Messages(reader)
    update(echo)
    read = exchange("\n".join(opened.errors))
    assert "TestRanksErrors" in read[0] and not any(read[1:]), read
    assert "upstream" in exchange("\n".join(messages.errors))[0]
    assert set(exchange(str(echo.GetOutput().GetNumberOfPoints()))) == {"0"}
    for name in (file, mesh):
        os.remove(name)


def test_abort():
    """One rank hears of the wish; all have empty outputs and no error."""
    for fraction in (0.0, 0.5):
        echo = echotools.scan(TOWN, **SETTINGS)
        messages = echotools.Messages(echo)

        def heard(caller, _):
            if RANK == LAST and echo.GetProgress() >= fraction:
                caller.SetAbortExecute(1)

        observer = echo.AddObserver("ProgressEvent", heard)
        update(echo)
        assert [echo.GetOutput(port).GetNumberOfPoints() for port in (0, 1)] == [0, 0]
        assert not any(exchange("".join(messages.errors)))
        echo.RemoveObserver(observer)
        echo.SetAbortExecute(0)
        echo.Modified()
        check_good(echo)


def test_abort_upstream():
    """One rank hears of the wish while the tree or the beams are made."""
    for upstream in (0, 1):
        sensor, tree = echotools.sensor(), al.vtkAvianLidarCollisionTree()
        tree.SetInputData(TOWN)
        echo = echotools.scan(tree, sensor, **SETTINGS)
        asked = (sensor, tree)[upstream]
        messages = echotools.Messages(sensor, tree, echo)

        def heard(caller, _):
            if RANK == LAST:
                caller.SetAbortExecute(1)

        observer = asked.AddObserver("ProgressEvent", heard)
        update(echo)
        assert [echo.GetOutput(port).GetNumberOfPoints() for port in (0, 1)] == [0, 0]
        assert not any(exchange("".join(messages.errors)))
        asked.RemoveObserver(observer)
        for algorithm in (sensor, tree, echo):
            algorithm.SetAbortExecute(0)
            algorithm.Modified()
        check_good(echo)


if __name__ == "__main__":
    main([test_bad_surfaces, test_bad_coordinates, test_block_of_2_gib, test_bad_surfaces_of_the_tree, test_bad_beams, test_bad_settings,
          test_settings_that_differ,
          test_beams_of_two_sensors, test_missing_file, test_missing_file_of_vtk, test_errors_as_data, test_damaged_mesh, test_abort, test_abort_upstream])
