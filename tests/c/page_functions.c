/* SPDX-License-Identifier: Apache-2.0 */
#include "page_functions.h"

#include <stdio.h>
#include <string.h>

int64_t now_ns(void) {
  static int64_t looks = 0;
  return ++looks * 60000000;
}

#include "function_2_of_page.inc"
#include "function_3_of_page.inc"
#include "function_4_of_page.inc"
#include "function_6_of_page.inc"
#include "function_7_of_page.inc"
