#include <fascia/measure/deformation.h>
