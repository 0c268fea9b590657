# Start-up file of JupyterLab's terminals: the user's own first, then the course's environment back to the front.
[ -f ~/.bashrc ] && . ~/.bashrc
PATH="$COURSE_KIT_PREFIX/bin:$PATH"
