# SPDX-License-Identifier: BSD-3-Clause
"""One page of HTML with a scene in three dimensions: surfaces, echoes, sequences, coverage and tracks."""
from __future__ import annotations

import base64
import json
import math
import pathlib
import re
import warnings
import zlib
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from ... import vtkAvianLidar as _wrapped
from ..._cloud import Cloud, as_numpy, field_values, triangles_of
from ..._disk import write_whole
from ..._files import numbers_of
from ..._look import GROUND, UNKNOWN, class_colour, on_surfaces, scale_of, species_colours
from ..._pipeline import Error, callers_level, update
from ..._plot import hue_colors, shortened
from ..._scene import Scene
from ..inputs._json import naming
from ..inputs._tables import read_table
from ..sequences._labels import CLASSES as LABELS

SCRIPTS = pathlib.Path("/usr/share/javascript/three")  # where Debian's libjs-three puts its files
THREE = ("three.min.js", "examples/js/controls/OrbitControls.js")
MOST_BYTES = 20_000_000  # size of a page
MOST_ECHOES = 1_200_000  # echoes of a page; of more, a random choice is shown
MOST_EDGES = 100_000  # lines along edges of buildings
MOST_BEAMS = 400  # drawn beams
SHARP = 30.0  # angle between faces from which on their common edge is drawn, deg


def _block(values: np.ndarray) -> Dict[str, Any]:
    """Numbers for the page: compressed, little-endian."""
    values = np.ascontiguousarray(values)
    kind = values.dtype.newbyteorder("<")
    packed = zlib.compress(values.astype(kind).tobytes(), 6)
    return {"type": values.dtype.name, "values": base64.b64encode(packed).decode()}


def _in_steps(points: np.ndarray) -> Dict[str, Any]:
    """Points as whole steps of 1/65535 of their extent along each axis."""
    low = points.min(axis=0, initial=np.inf) if len(points) else np.zeros(3)
    step = (points.max(axis=0) - low if len(points) else np.zeros(3)) / 65535
    steps = np.rint((points - low) / np.where(step > 0.0, step, 1.0)).astype(np.uint16)
    return {"low": low.tolist(), "step": step.tolist(), "places": _block(steps)}


def _surfaces(scene: Scene, centre: np.ndarray) -> Dict[str, Any]:
    """Triangles by object, colours by class, and sharp edges of what stands on the ground."""
    data = scene._merged()
    points, cells = triangles_of(data)
    fields = field_values(data)
    names, classes = list(fields.get("object_names", ())), list(fields.get("object_classes", ()))
    of = as_numpy(data.GetCellData().GetArray("object_id")).astype(np.int64)
    of = np.where((of >= 0) & (of < len(names)), of, len(names))
    words = [*classes, *[""] * (len(names) + 1 - len(classes))]
    layer = np.array([GROUND.index(word) + 1 if word in GROUND else len(GROUND) + 1 for word in words])
    sorting = np.argsort(layer[of], kind="stable")
    cells, of = cells[sorting], of[sorting]
    edges = _edges(points, cells[layer[of] > len(GROUND)]).reshape(-1, 2, 3)
    about = centre if scene.lidar_position is None else np.array(scene.lidar_position)
    edges = edges[np.argsort(np.hypot(*(edges[:, 0, :2] - about[:2]).T), kind="stable")]  # the nearest first
    return {"points": _block((points - centre).astype(np.float32)), "cells": _block(cells.astype(np.uint32)),
            "objects": _block(of.astype(np.uint32)), "names": [*names, "surface"],
            "classes": [word or "surface" for word in words], "layers": layer.tolist(),
            "colours": [class_colour(word) for word in words],
            "edges": _block((edges[:MOST_EDGES].reshape(-1, 3) - centre).astype(np.float32)),
            "edges_left_out": max(0, len(edges) - MOST_EDGES)}


def _edges(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Ends of the sharp edges and borders of triangles, two for each edge. (vtkFeatureEdges takes minutes where many
    triangles share a point.)"""
    if not len(cells):
        return np.zeros((0, 3))
    places, same = np.unique(points[cells.ravel()], axis=0, return_inverse=True)
    corners = same.reshape(-1, 3)
    normals = np.cross(*(places[corners[:, k]] - places[corners[:, 0]] for k in (1, 2)))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    pairs = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    order = np.lexsort(pairs.T[::-1])
    triangle = np.tile(np.arange(len(corners)), 3)[order]
    ends, first, count = np.unique(pairs[order], axis=0, return_index=True, return_counts=True)
    next_one = triangle[np.minimum(first + 1, len(triangle) - 1)]
    cosine = np.abs(np.einsum("ij,ij->i", normals[triangle[first]], normals[next_one]))
    shown = (count == 1) | ((count == 2) & (cosine < math.cos(math.radians(SHARP))))
    return places[ends[shown & (ends[:, 0] != ends[:, 1])]].reshape(-1, 3)


def _labels(scene: Scene) -> List[Dict[str, Any]]:
    """Names of runway ends, and of the largest buildings that have a name of their own."""
    landmarks = _wrapped.vtkAvianLidarLandmarks()
    landmarks.SetInputDataObject(1, scene._merged())
    update(landmarks)
    names = landmarks.GetOutput(2)
    return [{"text": shortened(names.GetPointData().GetAbstractArray("name").GetValue(i)), "at": [*names.GetPoint(i)]}
            for i in range(names.GetNumberOfPoints())]


def _on_one_scale(clouds: Iterable[Dict[str, Any]]) -> None:
    """Gives the energies of all clouds one scale of colours, and each cloud a unit that fits."""
    found = [one["energy"] for one in clouds if "energy" in one]
    ends = [end([energy[key] for energy in found], default=1.0) for end, key in ((min, "low"), (max, "high"))]
    words = ["{1:.3g} {0}".format(unit, end * scale) for end in ends for unit, scale in [scale_of(end)]]
    for energy in found:
        unit, scale = scale_of(energy["high"])
        energy.update(low=energy["low"] * scale, high=energy["high"] * scale, unit=unit, ends=words,
                      scale=[end * scale for end in ends])


def _echoes(cloud: Cloud, name: str, share: float, generator: np.random.Generator) -> Dict[str, Any]:
    """A share of a cloud of echoes in a random order, so that the first points are a fair choice of all."""
    points = cloud.points
    kept = np.flatnonzero(np.isfinite(points).all(axis=1))
    kept = kept[generator.permutation(len(kept))[:math.ceil(share * len(kept))]]
    fields = cloud.fields
    found: Dict[str, Any] = {"name": name, "count": len(kept), "of": len(points), **_in_steps(points[kept])}
    if "energy" in cloud:
        energy = np.nan_to_num(cloud["energy"][kept].astype(float), posinf=0.0, neginf=0.0)
        low = fields.get("lower_energy_limit", energy[energy > 0.0].min(initial=np.inf))
        high = fields.get("upper_energy_limit", energy.max(initial=0.0))
        low, high = (float(np.ravel(limit)[0]) for limit in (low, high))
        if 0.0 < low < high < np.inf:
            whole = np.log(np.clip(energy, low, high) / low) / np.log(high / low)
            found["energy"] = {"low": low, "high": high, "steps": _block(np.rint(65535 * whole).astype(np.uint16))}
    if "object_id" in cloud:
        ids, names = cloud["object_id"][kept], list(fields.get("object_names", ()))
        classes = list(fields.get("object_classes", ()))
        ids = np.where(ids == -1, len(names), np.where(ids == -2, len(names) + 1, np.where(
            (ids < 0) | (ids >= len(names)), len(names) + 2, ids)))
        words = [*classes, *["unknown"] * (len(names) - len(classes)), "noise", "air", "unknown"]
        found["objects"] = {"names": [*names, "false alarm", "air", "unknown"], "of": _block(ids.astype(np.uint32)),
                            "classes": words, "colours": [on_surfaces(class_colour(word)) for word in words]}
    elif "semantic_label" in cloud:
        labels = cloud["semantic_label"][kept].astype(np.int64)
        known, of = np.unique(labels, return_inverse=True)
        words = [LABELS[label].name if label in LABELS else f"label {label}" for label in known.tolist()]
        found["objects"] = {"names": words, "classes": words, "of": _block(of.astype(np.uint16)), "colours": [
            _label_colour(label) for label in known.tolist()]}
    if "position" in fields:
        found["lidar"] = np.ravel(fields["position"])[:3].tolist()
    return found


def _label_colour(label: int) -> str:
    return "#%02x%02x%02x" % tuple(reversed(LABELS[label].color)) if label in LABELS else UNKNOWN


def _finite(words: Sequence[str]) -> List[float]:
    numbers = [float(word) for word in words]
    if not np.isfinite(numbers).all():
        raise ValueError("expected finite numbers")
    return numbers


def _numbers(file: pathlib.Path, row: Mapping[str, str], names: Sequence[str]) -> List[float]:
    """Numbers of a row of a table. @throws Error that names the file and the columns"""
    with naming(f"{file}: {', '.join(names)}"):
        return _finite([row[name] for name in names])


def _sequence(folder: pathlib.Path) -> Dict[str, Any]:
    """The first scan of a sequence, and birds and other movers by scan. @param folder a sequence, or a folder of
    sequences, of which the first is taken"""
    inner = sorted(folder.glob("sequences/[0-9]*/truth.csv"))
    file = next((one for one in (folder / "truth.csv", *inner) if one.is_file()), None)
    if file is None:
        raise Error(f"{folder}: holds no truth.csv, expected a folder that `avianlidar sequence` has made")
    rows = read_table(file, ("scan", "bird", "species", "time_s", "x_m", "y_m", "z_m", "points"),
                      "expected the truth.csv of a sequence of `avianlidar sequence`")
    birds: Dict[str, Dict[str, Any]] = {}
    for row in rows:
        if not row["x_m"]:  # the bird is not there yet, or no more
            continue
        bird = birds.setdefault(row["bird"], {"name": f"{row['species']} {row['bird']}", "species": row["species"],
                                              "path": []})
        bird["path"].append(_numbers(file, row, ("time_s", "x_m", "y_m", "z_m", "points")))
    times = numbers_of(file.with_name("times.txt"), 1).ravel()
    if not len(times):
        raise Error(f"{file.with_name('times.txt')}: is empty, expected the time of each scan")
    species = sorted({bird["species"] for bird in birds.values()})
    known = species_colours(species)
    colours = {name: known[name] for name in species}
    others: Dict[str, Dict[str, Any]] = {}
    for number, time in enumerate(times.tolist()):
        boxes = file.parent / "boxes" / f"{number:06d}.txt"
        for line in boxes.read_text(encoding="utf-8").splitlines() if boxes.is_file() else ():
            words = line.split()
            if words and words[0] != "bird":
                with naming(f"{boxes}: '{line}'"):
                    x, y, z, *size, heading = _finite(words[3:10])
                    box_id = words[10]
                box = others.setdefault(box_id, {"name": f"{words[0]} {box_id}", "size": size, "path": []})
                box["path"].append([time, x, y, z, heading])
    reader = _wrapped.vtkAvianLidarSequenceReader()
    reader.SetFileName(str(file.with_name("times.txt")))
    update(reader)
    return {"name": file.parent.name, "scan": Cloud(reader.GetOutput()), "from": float(times[0]),
            "to": float(times[-1]),
            "birds": [{**bird, "colour": colours[bird["species"]]} for bird in birds.values()],
            "species": colours, "others": list(others.values())}


def map_of(height: float, west: float, north: float, step: Sequence[float], values: np.ndarray) -> Dict[str, Any]:
    """A map of probabilities for a page. @param west, north border, m @param step width and height of a pixel, m
    @param values rows (from north to south) x columns"""
    shares = np.clip(np.nan_to_num(values), 0.0, 1.0)
    return {"height": height, "west": west, "north": north, "step": list(step), "shape": values.shape,
            "values": _block(np.rint(255 * shares).astype(np.uint8))}


def maps_in(folder: pathlib.Path) -> List[Dict[str, Any]]:
    """The maps of detection probabilities in a folder, by height."""
    from ..places._gdal import gdal, open_file
    files = {float(match[1]): file for file in folder.glob("detection_probability_*m.tif")
             if (match := re.fullmatch(r"detection_probability_(.+)m\.tif", file.name))}
    if not files:
        raise Error(f"{folder}: no detection_probability_*m.tif, expected the maps of `avianlidar coverage`")
    maps = []
    for height, file in sorted(files.items()):
        image = open_file(file, "a map", ["GTiff"], gdal.OF_RASTER)
        west, step, _, north, _, down = image.GetGeoTransform()
        maps.append(map_of(height, west, north, (step, -down), image.ReadAsArray()))
    return maps


def _tracks(file: pathlib.Path, of: str = "") -> List[Dict[str, Any]]:
    """Lines of the tracks in a table. @param of name of an input, whose first sequence is taken; default: all tracks"""
    rows = read_table(file, ("track", "time_s", "x_m", "y_m", "z_m"), "expected tracks.csv of `avianlidar track`")
    lines: Dict[Tuple[str, ...], List[List[float]]] = {}
    for row in rows:
        key = tuple(row.get(name, "") for name in ("input", "sequence", "track"))
        if of and key[:2] != (of, "00"):
            continue
        lines.setdefault(key, []).append(_numbers(file, row, ("time_s", "x_m", "y_m", "z_m")))
    return [{"name": f"track {key[-1]}", "path": path} for key, path in lines.items()]


def page(scene: Scene, title: str, echoes: Sequence[Tuple[str, Cloud]] = (), sequence: Optional[pathlib.Path] = None,
         coverage: Sequence[Dict[str, Any]] = (), tracks: Optional[pathlib.Path] = None, tracks_of: str = "",
         lidar=None) -> bytes:
    """The page. @param echoes names and clouds @param sequence folder of a sequence, whose first scan is shown, too
    @param coverage maps by map_of() @param tracks table of tracks @param tracks_of name of an input in the table whose
    first sequence is shown; default: all @param lidar position, m; default: that of the echoes
    or of the scene. @throws Error that names the input"""
    import jinja2
    from markupsafe import Markup
    if not scene.number_of_triangles:
        raise Error(f"{title}: no surfaces to show")
    bounds = np.reshape(scene.bounds, (3, 2))
    centre = np.round(bounds.mean(axis=1))
    generator = np.random.default_rng(0)
    birds = _sequence(sequence) if sequence else None
    echoes = [*echoes, *([("scan 0", birds.pop("scan"))] if birds else [])]
    share = min(1.0, MOST_ECHOES / max(1, sum(cloud.number_of_points for _, cloud in echoes)))
    shown = [_echoes(cloud, name, share, generator) for name, cloud in echoes]
    _on_one_scale(shown)
    lidar = lidar or next((one["lidar"] for one in shown if "lidar" in one), scene.lidar_position)
    data = {"title": title, "centre": centre.tolist(), "bounds": bounds.tolist(), "lidar": lidar,
            "surfaces": _surfaces(scene, centre), "labels": _labels(scene), "echoes": shown,
            "beams": MOST_BEAMS, "hues": [_hex(row) for row in hue_colors().colors],
            "shades": _gradient(),
            "sequence": birds, "coverage": {"maps": list(coverage)} if coverage else None,
            "tracks": _tracks(tracks, tracks_of) if tracks else []}
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    text = text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    here = pathlib.Path(__file__).parent
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(here), autoescape=True,
                                     undefined=jinja2.StrictUndefined)
    return environment.get_template("view.html.jinja").render(
        title=title, data=Markup(text), scripts=[Markup(script) for script in _scripts(here)]).encode()


def _hex(row: Iterable[float]) -> str:
    return "#%02x%02x%02x" % tuple(int(round(255 * value)) for value in list(row)[:3])


def _gradient() -> List[str]:
    """256 colours of a share, from 0 to 1."""
    from matplotlib import colormaps
    return [_hex(row) for row in colormaps["viridis"](np.linspace(0.0, 1.0, 256))]


def _scripts(here: pathlib.Path) -> List[str]:
    """The scripts of the page: three.js, its controls and our own."""
    missing = [str(SCRIPTS / name) for name in THREE if not (SCRIPTS / name).is_file()]
    if missing:
        raise Error(f"{missing[0]}: no such file: a page needs three.js (Debian's package libjs-three)")
    return [*((SCRIPTS / name).read_text(encoding="utf-8") for name in THREE),
            (here / "view.js").read_text(encoding="utf-8")]


def beside(file: pathlib.Path, scene: Union[Scene, str], *things: Any, **more: Any) -> bool:
    """Writes a page beside other results, or warns if the page cannot be made. @param scene a scene, or its file @param
    things as for page() @return whether the page was written"""
    try:
        write(file, page(scene if isinstance(scene, Scene) else Scene(scene), *things, **more))
    except (RuntimeError, OSError, ValueError, ImportError, MemoryError) as error:
        warnings.warn(f"{file.name} is left out: {error}", RuntimeWarning, stacklevel=callers_level())
        return False
    return True


def write(file: pathlib.Path, content: bytes) -> None:
    """Writes a page. @throws Error if the page is too large"""
    if len(content) > MOST_BYTES:
        raise Error(f"{file}: the page would have {len(content) / 1e6:.1f} MB, expected at most {MOST_BYTES / 1e6:g} "
                    "MB: give fewer echoes, or a scene with fewer triangles")
    write_whole(file, content)

