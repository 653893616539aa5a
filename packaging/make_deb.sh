#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes Debian's source package and the three binary packages of what is committed, asks lintian, and builds a program with
# them: make_deb.sh [FOLDER, build/deb]
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$(realpath -m "${1:-build/deb}")
version=$(sed -n 's/^crofton (\(.*\)).*/\1/p;q' packaging/debian/changelog)
source_folder=$folder/crofton-$version
rm -rf "$folder"
mkdir -p "$source_folder"
git archive HEAD | tar -x -C "$source_folder"
cp -r packaging/debian "$source_folder/debian"
cd "$source_folder"
dpkg-buildpackage -us -uc
cd "$folder"
# The project has no mail address of its own yet, and is in no bug tracker of Debian's.
lintian --allow-root --fail-on error,warning \
    --suppress-tags initial-upload-closes-no-bugs,bogus-mail-host,bogus-mail-host-in-debian-changelog crofton_"$version"_*.changes
# A program in C, built with what the packages hold and nothing else of the source tree.
root=$folder/root
for package in libcrofton0 libcrofton-dev crofton-tools; do
    dpkg-deb -x "$package"_"$version"_*.deb "$root"
done
libraries=$(dirname "$root"/usr/lib/*/libcrofton.so.0)
gcc -I"$root/usr/include" "$source_folder/samples/c_hello/main.c" -L"$libraries" -lcrofton -o "$folder/c_hello"
LD_LIBRARY_PATH=$libraries "$folder/c_hello"
LD_LIBRARY_PATH=$libraries "$root/usr/bin/crofton" --version
ls -- *.deb *.dsc
