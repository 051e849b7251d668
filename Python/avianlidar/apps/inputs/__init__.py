# SPDX-License-Identifier: BSD-3-Clause
"""Files that a user gives, and the sensors, the air and the weather that these files name."""
