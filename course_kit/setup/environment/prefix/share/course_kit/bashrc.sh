# Start-up file of JupyterLab's terminals: the user's own first, then the course's environment back to the front.
[ -f ~/.bashrc ] && . ~/.bashrc
PATH="$COURSE_KIT_PREFIX/bin:$PATH"
# Tab completes `ros2`. A sourced ROS 2 that brings its own command brings its own completion too.
[ -x "$COURSE_KIT_PREFIX/bin/ros2" ] && eval "$("$COURSE_KIT_PREFIX/bin/register-python-argcomplete" ros2)"
