"""What trimesh and PyVista simplify by, at its defaults: in_fast_simplification.py SOURCE TARGET target_reduction=VALUE"""

import sys

import fast_simplification
import surface

source, target, words = sys.argv[1:]
name, value = surface.setting(words)
surface.write(target, *fast_simplification.simplify(*surface.read(source), **{name: value}))
