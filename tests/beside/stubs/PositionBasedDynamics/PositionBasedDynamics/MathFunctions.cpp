// XPBD.cpp needs nothing from this file here.
