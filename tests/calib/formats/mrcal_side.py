#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""mrcal's side of the test of cameramodels.

    mrcal_side.py project FILE POINTS        pixels of the points (x y z a line) of the reference
    mrcal_side.py rewrite FILE OUTPUT        mrcal's own reading and writing

Exits with 77 where there is no mrcal.
"""
import sys

try:
    import mrcal
    import numpy as np
except ImportError:
    sys.exit(77)

model = mrcal.cameramodel(sys.argv[2])
if sys.argv[1] == 'rewrite':
    model.write(sys.argv[3])
else:
    points = np.loadtxt(sys.argv[3]).reshape(-1, 3)
    in_camera = mrcal.transform_point_rt(model.extrinsics_rt_fromref(), points)
    for pixel in mrcal.project(in_camera, *model.intrinsics()):
        print(*(repr(float(x)) for x in pixel))
