# SPDX-License-Identifier: BSD-3-Clause
"""Results of lidars at sites for given places, kept in files, so that stopped runs continue and ranks share work."""
from __future__ import annotations

import contextlib
import hashlib
import io
import itertools
import os
import pathlib
import warnings
from typing import Any, Callable, List, Mapping, Optional, Sequence

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from ..._cloud import as_numpy, field_values, rows_of, with_points
from ..._coverage import Coverage
from ..._disk import write_whole
from ..._files import read_regular
from ..._numbers import figures
from ..._pipeline import Error, Updates, callers_level, update
from ..._ranks import Ranks, as_json, digest_of, digest_of_arrays
from ..._version import __version__

SAME_BIRDS = 20_000  # number of places whose poses are in memory together: 6 MB for each sensor and air


def _checked_sites(sites) -> np.ndarray:
    sites = rows_of("sites", sites, (3,))
    if not np.isfinite(sites).all():
        raise ValueError("sites are not all finite, expected coordinates in metres")
    return sites


def look(scene, sensor, sites, places, species: Sequence[str], folder=None, ranks: Optional[Ranks] = None,
         progress: Optional[Callable[[int, int], Any]] = None, array: str = "detection_probability",
         area_factor: float = 1.0, airs: Sequence[Mapping[str, Any]] = ({},), **settings: Any) -> np.ndarray:
    """Results of a lidar at each site for each place: float32, sites x species x places. With several airs: sites x
    (species x airs) x places, where the airs of a species are neighbours. Clutter is off unless `clutter` is on. The
    default `number_of_threads` is all cores, and 1 on several ranks, which share the sites.

    sensor       a Sensor; its position is changed and restored
    sites        n x 3, m
    places       m x 3, m
    species      names of species; "" with `effective_area`
    folder       folder with one file for the result of each site. A second call with the same scene, sensor, places and
                 other inputs reads these files, also after the first call was stopped. Required on several ranks, which
                 share the sites
    progress     called with the number of finished sites and the number of all sites of this process
    array        a point array of vtkAvianLidarCoverage
    area_factor  factor on each species' mean effective area
    airs         further settings, all with the same names: visibility, rain_rate, ... Lines of sight are traced once
                 for all airs
    settings     properties of Coverage, for example visibility=10e3 (m)

    @throws ValueError that names the argument, Error of Coverage
    """
    sites, places, ranks = _checked_sites(sites), np.asarray(places, dtype=float), ranks or Ranks()
    if not area_factor > 0.0:
        raise ValueError(f"area_factor is {area_factor}, expected a number above 0")
    if ranks.size > 1 and folder is None:
        raise ValueError("folder is not given: ranks share their results there")
    before = sensor.position
    cover = Coverage(scene, sensor, places=places, clutter=False, number_of_threads=int(ranks.size > 1))
    cover.set(**settings)
    with ranks.together():
        try:
            sensor.position = (0.0, 0.0, 0.0)
            # the number of threads changes no bit
            inputs = {name: repr(value) for name, value in settings.items() if name != "number_of_threads"}
            known = [list(species), array, area_factor, inputs]
            if any(airs):
                known.append([dict(air) for air in airs])
            files = files_of(cover, sites, places, known, folder)
            ranks.agree(folder, lambda: [file.name for file in files])
            if len(sites):
                sensor.position = tuple(sites[0])  # so that a warning about a place names one of the sites
            areas = [cover.effective_area] * len(species)
            if area_factor != 1.0:
                areas = [area_factor * float(np.ravel(field_values(cover.set(species=name).data)["effective_area"])[0])
                         for name in species]
            sensor.position = (0.0, 0.0, 0.0)
            beams = vtkPolyData()  # which move from site to site; the sensor would make all beams again
            beams.ShallowCopy(sensor.beams.data)
            origins = as_numpy(beams.GetPoints().GetData())
            cover.algorithm.SetInputDataObject(0, beams)
            with Updates(cover.algorithm) as again:
                def look_from(i: int) -> List[np.ndarray]:
                    beams.SetPoints(with_points(origins + sites[i]).GetPoints())
                    rows = []
                    for (name, area), air in itertools.product(zip(species, areas), airs):
                        cover.set(species=name, effective_area=area, **air)
                        again()
                        values = cover.algorithm.GetOutputDataObject(0).GetPointData().GetArray(array)
                        if values is None:
                            raise ValueError(f"array is {array!r}, expected a point array of vtkAvianLidarCoverage")
                        rows.append(vtk_to_numpy(values))
                    return rows
                found = np.empty((len(sites), len(species) * len(airs), len(places)), dtype=np.float32)
                fill(found, files, ranks, look_from, progress)
        finally:
            sensor.position = before
    return found


def value_of_same_birds(scene, sensor, sites, places, species: Sequence[str], weights: np.ndarray,
                        airs: Sequence[Mapping[str, Any]] = ({},), **settings: Any) -> float:
    """The weighted share that at least one of the sites detects in one scan if all sites observe the same bird, whose
    heading and wing phase are equal for all sensors. In value_of, each sensor observes a different bird. Clutter is off
    unless `clutter` is on.

    sensor    a Sensor; its position is changed and restored
    sites     n x 3, m: sites of the network
    places    m x 3, m
    species   names of species
    weights   species x places, from weights_of; with several airs (species x airs) x places
    airs      as in look
    settings  properties of Coverage, for example visibility=10e3 (m)

    @throws ValueError that names the argument, Error of Coverage
    """
    sites, places = _checked_sites(sites), np.asarray(places, dtype=float)
    rows = len(species) * len(airs)
    if weights.shape != (rows, len(places)):
        raise ValueError(f"weights have the shape {weights.shape}, expected species x places, {(rows, len(places))}")
    if not (np.isfinite(weights).all() and np.min(weights, initial=0.0) >= 0):
        raise ValueError(f"weights have {np.min(weights):g} among them, expected finite numbers of at least 0")
    before, value = sensor.position, 0.0
    cover = Coverage(scene, sensor, clutter=False)
    cover.set(**settings)
    cover.pose_probabilities = True
    try:
        for first in range(0, len(places), SAME_BIRDS):
            part = slice(first, first + SAME_BIRDS)
            cover.places = places[part]
            for number, name in enumerate(species):
                cover.species = name
                weight = weights[number * len(airs):(number + 1) * len(airs), part]
                missed: np.ndarray = np.ones((*weight.shape, 1), dtype=np.float32)  # airs x places x poses
                for site in sites:
                    sensor.position = tuple(site)
                    found = []
                    for air in airs:
                        cover.set(**air)
                        found.append(cover["pose_probabilities"].reshape(weight.shape[1], -1))
                    missed = missed * (1.0 - np.stack(found))
                value += float(np.vdot(weight, 1.0 - missed.mean(axis=2, dtype=float)))
    finally:
        sensor.position = before
    return value


def require_memory(needed: float, what: str, instead: str) -> None:
    """Error if results exceed this computer's memory. @param needed bytes @param instead advice to the user"""
    there = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if needed > there:
        needs, has = figures(needed / 1e9, 3), figures(there / 1e9, 3)
        raise Error(f"{what} need {needs} GB, but the memory has {has} GB: {instead}")


def files_of(cover: Coverage, sites, places, inputs, folder) -> List[pathlib.Path]:
    """The file of each site, named by a checksum of everything that decides the result."""
    if folder is None:
        return []
    home = pathlib.Path(folder)
    home.mkdir(parents=True, exist_ok=True)
    update(cover.scene.tree)
    table = hashlib.sha256(read_regular(cover.species_file_name)).hexdigest() if cover.species_file_name else ""
    known = [digest_of(cover.scene.tree.GetOutput()), __version__, digest_of_arrays(cover.sensor.beams.data), inputs,
             table]
    common = hashlib.sha256(as_json(known) + places.tobytes())
    digests = [common.copy() for _ in sites]
    for digest, site in zip(digests, sites):
        digest.update(site.tobytes())
    return [home / f"{digest.hexdigest()[:32]}.npy" for digest in digests]


def fill(found: np.ndarray, files: Sequence[pathlib.Path], ranks: Ranks, make: Callable[[int], Any],
          progress: Optional[Callable[[int, int], Any]] = None, key: Callable[[int], Any] = lambda i: i) -> None:
    """Reads each row from its file, and makes and writes missing rows. Ranks share this work.

    make  function that makes a row from its number
    key   equal for neighbouring rows that one rank must make
    """
    kept = {i for i, file in enumerate(files) if _read_kept(file, found[i])}
    damaged = [str(file) for i, file in enumerate(files) if i not in kept and os.path.lexists(file)]
    ranks.wait()  # all ranks have read before any rank writes
    if damaged and ranks.rank == 0:
        warnings.warn(f"kept coverage is damaged and is made again: {', '.join(damaged)}", RuntimeWarning,
                      stacklevel=callers_level())
    todo = [i for i in range(len(found)) if i not in kept]
    groups = [list(of) for _, of in itertools.groupby(todo, key=key)]
    mine = [i for group in groups[ranks.rank::ranks.size] for i in group]
    for number, i in enumerate(mine):
        found[i] = make(i)
        if files:
            files[i].unlink(missing_ok=True)  # a damaged file may be a pipe
            write_whole(files[i], packed(found[i]))
        if progress:
            progress(number + 1, len(mine))
    ranks.wait()
    for i in sorted(set(todo) - set(mine)):  # rows of other ranks
        if not _read_kept(files[i], found[i]):
            raise Error(f"{files[i]}: is damaged, although another rank has just written this file")


def packed(values: np.ndarray) -> bytes:
    """The bytes of a file of values: .npy, followed by a checksum."""
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue() + hashlib.sha256(stream.getvalue()).digest()


def _read_kept(file: pathlib.Path, values: np.ndarray) -> bool:
    """Whether a file is complete and undamaged; its values are read into `values`."""
    with contextlib.suppress(OSError):
        content = file.read_bytes() if file.is_file() else b""
        if hashlib.sha256(content[:-32]).digest() == content[-32:]:
            read = np.load(io.BytesIO(content[:-32]))
            if (read.shape, read.dtype) == (values.shape, values.dtype):
                values[:] = read
                return True
    return False
