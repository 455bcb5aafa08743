#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""mrcal's uncertainty of a calibration that Vernier has solved.

    mrcal_uncertainty.py PROBLEM.json ANSWER.json
    mrcal_uncertainty.py --version

PROBLEM.json is written by `vernier check`: a board calibration in mrcal's form at its minimum, points
to project and pixel pairs to triangulate. ANSWER.json contains their covariances from
mrcal.projection_uncertainty and mrcal.triangulate (mrcal 2.2, method "mean-pcam").

If single lens parameters are fixed or tied, which mrcal does not support, or are nearly
indistinguishable, the problem has a matrix `basis`, L, whose columns span the free directions. The
factorisation of JᵀJ used by the two functions is then replaced by one that solves with
L (LᵀJᵀJL)⁻¹ Lᵀ: the covariance of the reduced problem, or of the same problem with less rounding error.

Exit codes: 0 success, 1 mrcal failed, 4 mrcal's Python module is missing.
"""
import json
import math
import re
import sys

try:
    import mrcal
    import numpy as np
    import scipy.sparse
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(4)


def version():
    """mrcal's Python module has no version; take it from the file name of the loaded library."""
    with open('/proc/self/maps') as maps:
        found = re.search(r'libmrcal\.so\.([0-9.]+)', maps.read())
    return found.group(1) if found else 'unknown'


def optimization_inputs(problem):
    """The problem as arguments of mrcal's functions, without outlier rejection or regularisation."""
    warp = np.array(problem['warp_m'], dtype=float)
    views = np.array(problem['views'], dtype=np.int32).reshape(-1, 2)
    indices = np.column_stack((views, views[:, 1] - 1)).astype(np.int32)
    corners = np.array(problem['corners'], dtype=float)
    return dict(
        lensmodel=problem['lens'],
        intrinsics=np.array(problem['intrinsics'], dtype=float),
        extrinsics_rt_fromref=np.array(problem['camera_poses'], dtype=float).reshape(-1, 6),
        frames_rt_toref=np.array(problem['board_poses'], dtype=float),
        points=None,
        observations_board=corners.reshape(len(views), problem['rows'], problem['columns'], 3),
        indices_frame_camintrinsics_camextrinsics=indices,
        observations_point=None,
        indices_point_camintrinsics_camextrinsics=None,
        imagersizes=np.array(problem['sizes_px'], dtype=np.int32),
        calobject_warp=warp if warp.any() else None,
        calibration_object_spacing=problem['spacing_m'],
        do_optimize_intrinsics_core=True,
        do_optimize_intrinsics_distortions=True,
        do_optimize_extrinsics=True,
        do_optimize_frames=True,
        do_optimize_calobject_warp=False,
        do_apply_regularization=False,
        do_apply_outlier_rejection=False,
        verbose=False)


class FreeDirections:
    """Replaces mrcal's factorisation if the problem has a basis."""

    def __init__(self, packed_jacobian, packed_basis):
        self.basis = packed_basis
        reduced = (packed_jacobian @ packed_basis).tocsr()
        reduced.sort_indices()
        self.factorization = mrcal.CHOLMOD_factorization(reduced)

    def solve_xt_JtJ_bt(self, bt):
        flat = bt.reshape(-1, bt.shape[-1])
        right = np.ascontiguousarray((self.basis.T @ flat.T).T)
        solved = self.factorization.solve_xt_JtJ_bt(right)
        return np.ascontiguousarray((self.basis @ solved.T).T).reshape(bt.shape)


def packed_basis(rig_basis, inputs):
    """The basis extended by the board poses, for parameters in mrcal's packed scale."""
    rig_basis = np.array(rig_basis, dtype=float)
    states = mrcal.num_states(**inputs)
    scale = np.ones(states)
    mrcal.unpack_state(scale, **inputs)
    poses = scipy.sparse.identity(states - rig_basis.shape[0])
    basis = scipy.sparse.block_diag((scipy.sparse.csc_matrix(rig_basis), poses)).tocsc()
    mover = np.asarray(abs(basis).argmax(axis=0)).ravel()
    return (scipy.sparse.diags(1 / scale) @ basis @ scipy.sparse.diags(scale[mover])).tocsr()


def restrict(rig_basis, inputs):
    """Makes mrcal's functions use the reduced problem from now on."""
    basis = packed_basis(rig_basis, inputs)
    original = mrcal.optimizer_callback

    def callback(**words):
        b, x, jacobian, _ = original(no_factorization=True, **words)
        return b, x, jacobian, FreeDirections(jacobian, basis)

    mrcal.optimizer_callback = callback


def projections(problem, models):
    answers = []
    for query in problem['projection']:
        answers.append(mrcal.projection_uncertainty(
            np.array(query['points']), models[query['camera']],
            atinfinity=query['at_infinity'], what='covariance',
            observed_pixel_uncertainty=problem['pixel_sigma_px']).tolist())
    return answers


def triangulations(problem, models):
    answers = []
    for query in problem['triangulation']:
        pixels = np.array(query['pixels'], dtype=float).reshape(-1, 2, 2)
        points, calibration, observation, _ = mrcal.triangulate(
            pixels, [models[0], models[query['other']]],
            q_calibration_stdev=problem['pixel_sigma_px'],
            q_observation_stdev=problem['pixel_sigma_px'],
            stabilize_coords=query['stabilised'])
        own = [calibration[i, :, i, :].tolist() for i in range(len(points))]
        answers.append(dict(points=points.tolist(), calibration=own,
                            observation=observation.tolist()))
    return answers


def numbers_or_null(answer):
    """Replaces NaN and infinity, which JSON does not have, by null."""
    if isinstance(answer, dict):
        return {key: numbers_or_null(value) for key, value in answer.items()}
    if isinstance(answer, list):
        return [numbers_or_null(value) for value in answer]
    return answer if not isinstance(answer, float) or math.isfinite(answer) else None


def main():
    if sys.argv[1:] == ['--version']:
        print(version())
        return
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1]) as file:
        problem = json.load(file)
    inputs = optimization_inputs(problem)
    models = [mrcal.cameramodel(optimization_inputs=inputs, icam_intrinsics=camera)
              for camera in range(len(problem['intrinsics']))]
    if problem['basis'] is not None:
        restrict(problem['basis'], inputs)
    answer = dict(version=version(), projection=projections(problem, models),
                  triangulation=triangulations(problem, models))
    with open(sys.argv[2], 'w') as file:
        json.dump(numbers_or_null(answer), file, allow_nan=False)


if __name__ == '__main__':
    main()
