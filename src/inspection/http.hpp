#pragma once

// Debian compiles cpp-httplib with TLS and compression; its header must be told the same.
#define CPPHTTPLIB_OPENSSL_SUPPORT
#define CPPHTTPLIB_ZLIB_SUPPORT
#define CPPHTTPLIB_BROTLI_SUPPORT
#include <httplib.h>
#undef _res  // a macro of resolv.h, and a parameter of Eigen's
