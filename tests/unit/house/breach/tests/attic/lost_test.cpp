// SPDX-License-Identifier: Apache-2.0
// This file is in no CMakeLists.txt: house.listed must find it.
