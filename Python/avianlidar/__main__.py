# SPDX-License-Identifier: BSD-3-Clause
"""Entry point of `python3 -m avianlidar`."""
import sys

from ._command import main

if __name__ == "__main__":
    code = main()
    if code:  # sys.exit(0) would end pvbatch before MPI is finalized
        sys.exit(code)
