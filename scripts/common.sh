# Shared by the scripts beside it, which source it: paths, messages, the environment to run in.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$root/.venv
messages_prefix=$venv/opt/sailenv_msgs # only beside an installed ROS 2

# Images of Python set it: then each process compiles all that it imports anew, for a second or two.
unset PYTHONDONTWRITEBYTECODE

say() { printf '%s\n' "$*" >&2; }
die() {
  printf '\nFAILED: %s\n' "$1" >&2
  shift
  printf '  %s\n' "$@" >&2
  exit 1
}

# A sourced ROS 2 Jazzy is used instead of the wheels; the two must not be mixed.
ros_is_sourced() { [[ ${ROS_DISTRO:-} == jazzy && -n ${AMENT_PREFIX_PATH:-} ]]; }

# The messages are what comes last of ROS.
ros_is_there() { [[ -f $venv/sailenv-messages ]]; }

refuse_other_ros() {
  [[ -z ${ROS_DISTRO:-} || $ROS_DISTRO == jazzy ]] || die \
    "ROS 2 '$ROS_DISTRO' is sourced here, and sailenv_ros is for Jazzy." \
    "Open a shell without it (the packages then come from PyPI), or source Jazzy instead."
}

enter_environment() {
  export VIRTUAL_ENV=$venv PATH=$venv/bin:$PATH
  if ros_is_sourced; then
    export AMENT_PREFIX_PATH=$venv:$AMENT_PREFIX_PATH
    set +u # ROS 2's own scripts read variables that are not set
    # shellcheck source=/dev/null
    source "$messages_prefix/share/sailenv_msgs/local_setup.bash"
    set -u
  fi
}

# step TITLE COMMAND...: run it, show how long it takes, keep its output for when it fails.
log=$root/build/setup.log
step() {
  local title=$1 started=$SECONDS status=0 pid
  shift
  mkdir -p "$(dirname "$log")"
  printf '\n== %s\n' "$title" >> "$log"
  if [[ -t 2 ]]; then
    "$@" >> "$log" 2>&1 < /dev/null &
    pid=$!
    while kill -0 "$pid" 2> /dev/null; do
      printf '\r  %s ... %d s ' "$title" $((SECONDS - started)) >&2
      sleep 0.5
    done
    wait "$pid" || status=$?
    printf '\r\033[K' >&2
  else
    say "  $title ..."
    "$@" >> "$log" 2>&1 < /dev/null || status=$?
  fi
  if ((status)); then
    say "  $title: failed after $((SECONDS - started)) s; the end of what it said:"
    tail -n 25 "$log" | sed 's/^/    | /' >&2
    return "$status"
  fi
  say "  $title: done in $((SECONDS - started)) s"
}
