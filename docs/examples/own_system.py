#!/usr/bin/env python3
"""A system under test as a program: how far off a gripper sees a parcel straight ahead."""
import json
import sys


def pair(cameras):
    """Focal length of the right camera, baseline, turn about y, shift of the image centres."""
    left, right = (camera['parameters'] for camera in cameras)
    pose = cameras[1]['from_first']
    return (right['f_px'] * right['ax'], -pose['translation_m'][0], pose['rotation_rad'][1],
            left['ox_px'] - right['ox_px'])


def disparity_px(cameras, z_m):
    """Of a point on the left axis, for a pair that is nearly parallel."""
    f_px, baseline_m, turn_rad, shift_px = pair(cameras)
    return shift_px + f_px * (baseline_m / z_m - turn_rad)


def depth_m(cameras, seen_px):
    """The inverse."""
    f_px, baseline_m, turn_rad, shift_px = pair(cameras)
    return f_px * baseline_m / (seen_px - shift_px + f_px * turn_rad)


hello = json.loads(sys.stdin.readline())
range_m = hello['parameters']['range_m']
print(json.dumps({'ready': True}), flush=True)
for line in sys.stdin:
    trial = json.loads(line)
    seen_px = disparity_px(trial['true_cameras'], range_m)
    off_m = depth_m(trial['told_cameras'], seen_px) - range_m
    print(json.dumps({'question': trial['question'], 'error': abs(off_m), 'off_m': off_m}), flush=True)
