# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML, pictures and sentences, which the commands write."""
