#include <fascia/fitting/fit_flesh.h>
