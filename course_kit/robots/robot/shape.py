"""The robot in numbers, after a TurtleBot 3 Burger: sizes, masses, motors, laser. SI units, frames after REP 103."""

from __future__ import annotations

# Geometry: base_link lies on the middle of the axle's line, BASE_HEIGHT above the floor; what follows is seen from it.
BASE_HEIGHT = 0.010  # m
WHEEL_RADIUS = 0.033  # m
WHEEL_SEPARATION = 0.160  # m, from the middle of one tyre to that of the other
WHEEL_WIDTH = 0.018  # m
WHEEL_HEIGHT = WHEEL_RADIUS - BASE_HEIGHT  # m, of the axle
RADIUS = 0.105  # m, of the body: a round one about base_link, so that a turn on the spot needs no more room
HEIGHT = 0.192  # m, from the floor to the top
CASTER = -0.081  # m, where the ball behind touches the floor
LASER = (-0.032, 0.0, 0.172)  # m, of base_scan
IMU = (-0.032, 0.0, 0.068)  # m, of imu_link

# Masses
WHEEL_MASS = 0.0285  # kg
MASS = 1.0  # kg, of all
CENTRE = (-0.02, 0.0, 0.045)  # m, of the mass without wheels; behind the axle, or it would fall on its nose
INERTIA = (0.0022, 0.0021, 0.0020)  # kg m², without wheels, about that point

# Motors
MAX_LINEAR = 0.22  # m/s
MAX_ANGULAR = 2.84  # rad/s
MAX_WHEEL_RATE = 8.0  # rad/s, what a motor is told at most
MAX_ACCELERATION = 1.0  # m/s², at the rim of a wheel: how fast the motors' controller lets the wanted rate change
MAX_TORQUE = 1.4  # N m: more than the tyres hold, so that before a wall the wheels slip

# Laser: that of the LDS-01
RAYS = 360  # one a degree, the first ahead, then counter-clockwise
SHORTEST, LONGEST = 0.12, 3.5  # m
SCAN_PERIOD = 0.2  # s

STEP = 0.005  # s, of the physics: a sample of the IMU each, 40 from scan to scan
