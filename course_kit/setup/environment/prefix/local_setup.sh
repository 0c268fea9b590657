# Makes this environment an underlay of colcon workspaces, as /opt/ros/jazzy is: each workspace's setup.sh reads it.
# colcon says where it is in COLCON_CURRENT_PREFIX. What it exports is what every Python of the environment has.
if [ -z "${COLCON_CURRENT_PREFIX:-}" ]; then
  echo 'source local_setup.bash or local_setup.zsh: a plain sh cannot tell where this file is' >&2
else
  eval "$("$COLCON_CURRENT_PREFIX/bin/python" -m course_kit.setup.environment.exports)"
fi
