# Sourced by the fleet's scripts: $fleet_python runs this repository's Python package `fleet`. With fleet_without_parquet set, a missing
# network leaves Debian's python3, which lacks Parquet only.
fleet_environment=$KNEE_BUILD/fleet/venv
case ${1:-} in
  --help | -h)  # asked of a machine where nothing is installed: installs nothing
    if [[ ! -f $fleet_environment/.pyarrow ]]; then
      sed -n '2,/^[^#]/s/^# \?//p' "$0"
      echo "Run it once, which installs its packages: --help lists its options afterwards."
      exit 0
    fi ;;
  *) "$KNEE_ROOT/scripts/install_dependencies" --fleet >&2 ;;
esac
fleet_python=$fleet_environment/bin/python3
if [[ ! -f $fleet_environment/.pyarrow ]]; then
  rm -rf "$fleet_environment"
  mkdir -p "$KNEE_BUILD/fleet"
  /usr/bin/python3 -m venv --system-site-packages "$fleet_environment"
  if "$fleet_environment/bin/pip" install -q --disable-pip-version-check pyarrow==14.0.2 >"$KNEE_BUILD/fleet/pip.log" 2>&1; then
    touch "$fleet_environment/.pyarrow"
  elif [[ -n ${fleet_without_parquet:-} ]]; then
    echo "pyarrow could not be installed (see $KNEE_BUILD/fleet/pip.log): tests that need Parquet are skipped" >&2
  else
    fail "pyarrow could not be installed (network?); see $KNEE_BUILD/fleet/pip.log"
  fi
fi
export PYTHONPATH=$KNEE_ROOT PYTHONDONTWRITEBYTECODE=1 KNEE_BUILD OPENBLAS_NUM_THREADS=1
