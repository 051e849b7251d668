# SPDX-License-Identifier: BSD-3-Clause
"""The public name of `apps.siting`."""
import sys

from .apps import siting
from .apps.siting import *  # noqa: F401,F403  for who reads types

sys.modules[__name__] = siting
