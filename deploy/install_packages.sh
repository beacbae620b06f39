#!/usr/bin/env bash
# Installs the Debian packages that building, testing and running reident needs, where they are
# missing. Needs root (or sudo) only when something is missing.
#   deploy/install_packages.sh [--with-tests] [--with-bench] [--with-packages]
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache pkg-config
  libeigen3-dev cyclonedds-dev cyclonedds-tools libsqlite3-dev libzstd-dev libssl-dev
  libcli11-dev libfmt-dev libspdlog-dev libtomlplusplus-dev nlohmann-json3-dev
  libzip-dev libmatio-dev libhowardhinnant-date-dev tzdata libxml2-dev
  libboost1.81-dev libboost-url1.81-dev zlib1g-dev  # the operators' page
)
for option in "$@"; do
  case $option in
    --with-tests)
      packages+=(libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev systemd
                 clang clang-format clang-tidy python3 python3-yaml sqlite3 git octave valgrind
                 chromium slurm-wlm munge)
      # Node from elsewhere brings npm along, and does not go together with Debian's.
      command -v npm >/dev/null || packages+=(nodejs npm)
      ;;
    --with-packages)  # what makes Debian packages, and tries them
      packages+=(dpkg-dev file help2man lintian debootstrap systemd-container nftables iproute2 faketime)
      ;;
    --with-bench)  # what identification is compared with
      packages+=(libslicot-dev libopenblas0 octave-control)
      ;;
    *)
      echo "usage: deploy/install_packages.sh [--with-tests] [--with-bench] [--with-packages]" >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' ||
    missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "These packages are missing and need root to install: ${missing[*]}" >&2
    exit 1
  }
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" apt-get install -q -y --no-install-recommends "${missing[@]}"
