# SPDX-License-Identifier: BSD-3-Clause
"""In PYTHONPATH with NUMBA_ENABLE_CUDASIM=1: lets DiSimPy 0.3.0 run without a GPU, beside today's NumPy and Numba.

It calls two functions of NumPy 1, and functions compiled for the CPU from within its kernels, which Numba's simulator of CUDA runs as plain Python.
"""
import importlib.abc
import os
import sys


class Lend(importlib.abc.MetaPathFinder):
    """Right after disimpy.simulations was imported, its compiled functions become plain ones."""

    def find_spec(self, name, path, target=None):
        if name != "disimpy.simulations":
            return None
        import numpy

        numpy.product, numpy.trapz = numpy.prod, numpy.trapezoid
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        execute = spec.loader.exec_module

        def then_plain(module):
            execute(module)
            for key, value in list(vars(module).items()):
                if type(value).__name__ == "CPUDispatcher":
                    setattr(module, key, value.py_func)

        spec.loader.exec_module = then_plain
        return spec


if os.environ.get("NUMBA_ENABLE_CUDASIM") == "1":
    import importlib.util

    sys.meta_path.insert(0, Lend())
