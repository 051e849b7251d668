# SPDX-License-Identifier: BSD-3-Clause
"""An airport as maps, a raster of heights and surveyed obstacles give it, and the features that its scene takes."""
from __future__ import annotations

import collections
import pathlib
import warnings
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from osgeo import osr

from ..._pipeline import Error
from ..inputs._json import packaged
from ..places._features import Feature, form_of, length_of, properties_of
from ..places._gdal import box_of, coordinate_system, corners_of, degrees, geometry, moved, valid
from ._extract import COAST, CUT, OUTSIDE, on_roofs, sea, without_parts
from ._ground import difference, height_at, posts_of, read_heights, terrain
from ._obstacles import read_obstacles
from ._osm import read_extract
from ._runways import choose_runways

LOWEST, HIGHEST = -500.0, 9000.0  # heights of level ground above the sea, m
LONGEST_NAME = 80  # characters
FLAT_SPACING = 100.0  # spacing of a ground without a terrain, which follows the curvature of the Earth, m


class Heights(NamedTuple):
    """Heights of the ground."""
    posts: np.ndarray          # heights above the origin, m, south first
    corner: Sequence[float]    # south-west post, m
    spacing: float             # m
    error: float               # greatest distance of the terrain's triangles from the heights, m
    words: str                 # source and error
    surface: Any               # the terrain (vtkPolyData, m)


class AirportMap:
    """An airport as given by an extract, a raster of heights and surveyed obstacles.

    runways, features    features of the extract and of the surveys
    left, unknown, used  features that the scene leaves out, features of unknown kinds by tag, and features that the
                         scene follows but does not draw
    origin               latitude, longitude (degrees) and height (m, 0 before `heights` has read the ground)
    rectangle            west, east, south and north end of the scene, m
    outline              of the aerodrome (ogr, degrees); None if the extract has none that contains all runways
    """

    def __init__(self, extract, heights=None, icao: Optional[str] = None, bounds: Optional[Sequence[float]] = None,
                 obstacles: Sequence[Any] = (), progress: Callable[[str, int, int], Any] = lambda *_: None):
        self.known, self.extract = packaged("places/airport.json"), pathlib.Path(extract)
        self.dem, self.level = self._ground(heights)
        self.progress = progress
        if bounds is not None:
            west, south, east, north = bounds
            if not (-180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0):
                raise ValueError(f"--bounds {west:g} {south:g} {east:g} {north:g}: "
                                 "expected west, south, east and north in degrees")
        progress("extract", 0, 1)
        found = read_extract(self.extract, self.known, bounds)
        self.features, self.left, self.unknown, self.used = found.features, found.left, found.unknown, found.used
        progress("extract", 1, 1)
        self.runways, aerodrome = choose_runways(self.extract, found, self.known, icao, bounds)
        self.obstacles = [pathlib.Path(file) for file in obstacles]
        surveyed, left = read_obstacles(self.obstacles, self.known)
        self.features += surveyed
        self.left += left
        self.tags = aerodrome.tags if aerodrome else {}
        name = self.tags.get("name") or self.tags.get("icao") or self.extract.name.split(".")[0]
        self.name = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}..."  # pictures have this title
        self._place(bounds)
        coasts = [one for one in self.features if one.kind == COAST]
        self.features = [one for one in self.features if one.kind != COAST]
        seas, near = sea(coasts, self.box), sum(one.shape.Intersects(self.box) for one in coasts)
        self.features += [Feature("water", {"name": "sea"}, shape, 0) for shape in seas]
        if near < len(coasts):
            self.left.append(Feature(COAST, {}, count=len(coasts) - near, reason=OUTSIDE))
        if seas:
            self.used[COAST] = near
        elif near:
            self.left.append(Feature(COAST, {}, count=near, reason="a coast that does not part the scene"))
            warnings.warn(f"{self.extract}: its coastlines do not part the scene: the scene has land in place of the "
                          "sea; draw the sea as natural=water, or cut the extract wider", RuntimeWarning, stacklevel=2)
        outline = valid(aerodrome.shape) if aerodrome and form_of(aerodrome.shape) == "area" else None
        self.outline = outline if outline is not None and all(
            outline.Contains(one.shape.Centroid()) for one in self.runways) else None

    @staticmethod
    def _ground(heights) -> Tuple[Optional[pathlib.Path], Optional[float]]:
        """The raster of heights, or the height of level ground above the sea, m."""
        if heights is None or pathlib.Path(heights).exists():
            return pathlib.Path(heights) if heights is not None else None, None
        try:
            level = float(str(heights))
        except ValueError:
            return pathlib.Path(heights), None
        if not LOWEST <= level <= HIGHEST:
            raise Error(f"--heights {heights}: expected a raster, or the height of level ground above the sea within "
                        f"{LOWEST:g} and {HIGHEST:g} m")
        return None, level

    def _level(self) -> Tuple[float, str]:
        """The height of level ground above the sea, m, and its source in words."""
        if self.level is not None:
            return self.level, "as --heights says"
        said = length_of(self.tags.get("ele"), HIGHEST)
        if said is not None:
            return round(said, 3), "the elevation (ele) of the aerodrome in the map"
        warnings.warn(f"{self.extract}: there are no --heights, and the map does not say the aerodrome's elevation: "
                      "level ground at 0 m is assumed. For birds with heights above the sea, give the elevation in metres, "
                      "for example --heights 69.5", RuntimeWarning, stacklevel=4)
        return 0.0, "assumed"

    def _place(self, bounds: Optional[Sequence[float]]) -> None:
        """Sets the origin and the rectangle of the scene."""
        ends = np.array([one.shape.GetPoints() for one in self.runways])[:, :, :2]
        low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
        if high[0] - low[0] > 180.0:
            raise Error(f"{self.extract}: its runways cross the meridian of 180 degrees, "
                        "where scenes of this command end")
        longitude, latitude = (low + high) / 2
        self.origin = (round(float(latitude), 7), round(float(longitude), 7), 0.0)
        local = coordinate_system(self.origin)
        self.to_local = osr.CoordinateTransformation(degrees(), local)
        self.to_degrees = osr.CoordinateTransformation(local, degrees())
        shape = moved(box_of(bounds) if bounds is not None else geometry("MultiLineString", ends), self.to_local)
        margin = 0.0 if bounds is not None else self.known["margin"]
        west, east, south, north = shape.GetEnvelope()
        self.rectangle = (west - margin, east + margin, south - margin, north + margin)
        around = moved(box_of([self.rectangle[i] for i in (0, 2, 1, 3)]), self.to_degrees).GetEnvelope()
        if np.ptp(around[:2]) > 180.0:
            raise Error(f"{self.extract}: the scene would reach over the meridian of 180 degrees; "
                        "set --bounds to the runways' side of it")
        self.box = box_of([around[i] for i in (0, 2, 1, 3)])

    def heights(self) -> Heights:
        """The ground. Also sets the height of the origin."""
        west, east, south, north = rectangle = np.add(self.rectangle, (-50.0, 50.0, -50.0, 50.0)).tolist()
        if self.dem is None:
            spacing, error = FLAT_SPACING, self.known["level_error"]
            posts = np.zeros(posts_of(rectangle, spacing))
            level, why = self._level()
            self.origin = (*self.origin[:2], level)
            words, off = f"heights: the ground is level at {level:.10g} m ({why}), and curves as the Earth does", ""
            surface, _ = terrain(posts, (west, south), spacing, self.origin, error)
        else:
            found = read_heights(self.dem, self.origin, rectangle, self.known)
            self.origin, error = (*self.origin[:2], round(found.here, 3)), self.known["terrain_error"]
            posts, spacing, words = found.posts - self.origin[2], found.spacing, found.words
            surface, ground = terrain(posts, (west, south), spacing, self.origin, error)
            off = difference(found, self.origin[2], self.origin, ground)
        return Heights(posts, (west, south), spacing, error,
                       f"{words}; triangles within {error:g} m of these heights{off}", surface)

    def chosen(self, ground: Heights) -> List[Feature]:
        """The features of the scene on this ground; others are added to `left`, with a reason."""
        found: List[Feature] = []
        outside: Dict[str, int] = collections.Counter()
        for one in [*self.runways, *(one for one in self.features
                                     if one.kind != "runway" or form_of(one.shape) != "line")]:
            if not (one.shape if one.shape.IsValid() else one.shape.ConvexHull()).Intersects(self.box):
                outside[one.kind] += one.count
                continue
            if "elevation" in one.tags and "height" not in one.tags:
                place = moved(one.shape.Centroid(), self.to_local).GetPoint_2D()
                above = float(one.tags["elevation"]) - self.origin[2] - height_at(*ground[:3], place)
                if self.dem is None or not above > 0.0:
                    self.left.append(one.left("an elevation without --heights" if self.dem is None else "below ground"))
                    continue
                one.tags = {**one.tags, "height": f"{above:.3f}",
                            "height_source": f"{one.tags['height_source']}, elevation less that of the ground"}
            found.append(one)
        self.left += [Feature(kind, {}, count=count, reason=OUTSIDE) for kind, count in outside.items()]
        found, drawn = without_parts(found, self.known)
        self.left += [one.left("drawn by its parts") for one in drawn]
        def height(x: float, y: float) -> float:
            return height_at(*ground[:3], self.to_local.TransformPoint(x, y)[:2])

        found, left = on_roofs(found, self.known, lambda area, point: (
            min(height(*corner) for corner in corners_of(area).tolist()) - height(point.GetX(), point.GetY())))
        self.left += left
        broken = {one.tags[CUT] for one in found if one.kind == "runway" and CUT in one.tags}
        if CUT in broken:
            warnings.warn(f"{self.extract}: a runway is {CUT}, and ends there: cut the extract wider", RuntimeWarning,
                          stacklevel=3)
        if broken - {CUT}:
            warnings.warn(f"{self.extract}: a runway has nodes with {', '.join(broken - {CUT})}, and is drawn without "
                          "them: mend these nodes, which assumed.csv lists", RuntimeWarning, stacklevel=3)
        return found

    def mapped(self, chosen: Sequence[Feature]) -> List[Tuple[Dict[str, Any], Any]]:
        """Properties for the scene file and shape of each feature. Flat areas, woods and lines end at the box."""
        rows = []
        for one in chosen:
            shape, rule = one.shape, self.known["kinds"][one.kind]
            ends = ("flat" in rule or "medium" in rule or form_of(shape) == "line") and one.kind != "runway"
            if ends and not self.box.Contains(shape):
                shape = valid(shape).Intersection(self.box)
            if shape is not None and not shape.IsEmpty():
                rows.append((properties_of(one, self.known), shape))
        return sorted(rows, key=lambda row: list(self.known["kinds"]).index(row[0]["kind"]))
