# SPDX-License-Identifier: BSD-3-Clause
"""What round drops of rain send straight back by Mie's theory, by wavelength and rain rate, and the terms of
Filters/Media/media.json that fit it. S is the extinction over the backscatter.

    Testing/Studies/run.py drops --out build/weather-drops
"""
import json
import pathlib

import numpy as np
from scipy.optimize import least_squares

import others
import tools
from running import argument, study, whole

MEDIA = pathlib.Path(__file__).resolve().parents[3] / "Filters" / "Media" / "media.json"
WATER = json.loads(MEDIA.read_text(encoding="utf-8"))["water"]
WAVELENGTHS = 0.905, 1.064, 1.2, 1.31, 1.45, 1.55  # um
RATES = 1, 10, 50  # mm/h
OF_905 = 20.0  # sr, assumed: real drops are not round, and S of round drops depends on the third digit of the index


def index_of(wavelength):
    """Complex refractive index of water. @param wavelength um"""
    length, index, extinction = np.transpose(WATER["rows"])
    return np.interp(wavelength, length, index) + 1j * np.exp(np.interp(wavelength, length, np.log(extinction)))


def ratio_of_terms(wavelength, rate, terms):
    """S of the rain of Marshall and Palmer, sr. @param terms efficiency and way in diameters, for each term"""
    index = index_of(wavelength)
    mean = 1e-3 * rate**0.21 / 4.1  # diameter, m
    lost = 4e6 * np.pi * index.imag / wavelength * mean
    front = abs((index.real - 1) / (index.real + 1))**2
    return 8 * np.pi / (front + sum(efficiency / (1 + way * lost)**3 for efficiency, way in terms))


def fitted(ratios):
    """The terms with the least squares of the logarithms of S. @param ratios S by wavelength and rate"""
    def errors(values):
        return [np.log(ratio_of_terms(*case, values.reshape(2, 2)) / ratio) for case, ratio in ratios.items()]
    return least_squares(errors, [0.1, 1.0, 1.2, 10.0], bounds=(0, 100)).x.reshape(2, 2)


@study(argument("--drops", type=whole(100, 10**6), default=4000, help="drops of each sum"))
def main(options):
    terms = [(term["efficiency"], term["way"]) for term in WATER["rear"]["terms"]]
    ratios, errors = {}, {}
    for wavelength in WAVELENGTHS:
        for rate in RATES:
            case = wavelength, rate
            _, ratios[case], errors[case] = others.rain_of_spheres(rate, options.drops, wavelength=wavelength,
                                                                   index=index_of(wavelength))
    rows = [(f"{1e3 * wavelength:.0f}", rate, f"{ratio:.3g} ± {ratio * errors[wavelength, rate]:.1g}",
             f"{ratio_of_terms(wavelength, rate, terms):.3g}") for (wavelength, rate), ratio in ratios.items()]
    used = {case: OF_905 if case[0] == WAVELENGTHS[0] else ratio for case, ratio in ratios.items()}
    print("best terms:", *(f"efficiency {efficiency:.3g}, way {way:.3g};" for efficiency, way in fitted(used)))
    tools.leave(options.out, "weather-drops",
                ("wavelength, nm", "rain rate, mm/h", "S of round drops, sr", "S of the simulator, sr"), rows, 2)
