# SPDX-License-Identifier: Apache-2.0
# Run by cpack before it packs: its lists of staged files name paths below /usr, and `uninstall` would remove those of an
# installed package.
list(GET CPACK_INSTALL_CMAKE_PROJECTS 0 build)
file(GLOB staged ${build}/install_manifest_*.txt)
file(REMOVE ${staged})
