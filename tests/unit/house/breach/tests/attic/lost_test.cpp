// SPDX-License-Identifier: Apache-2.0
// In no CMakeLists.txt: what house.listed must find.
