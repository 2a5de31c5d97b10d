"""The sources that models and materials stand on, each under a short key.

A model names its key in its docstring and in the results it takes part in, so that a report can
print what it rests on.
"""

from __future__ import annotations

from strikewave.base.errors import InputError, nearest

CHECKED, QUOTED, FROM_MEMORY = "checked", "quoted", "from memory"
"""Status of a law or a row of a table: the source itself was opened and has it; another text that was opened quotes
it, and is named; or neither could be opened for at least one number, which the note names."""

SOURCES: dict[str, str] = {
    "li-ma-2019": (
        "F. Li, S. Ma, Analysis and Experimental Study of Acceleration Model for Short Interval and "
        "Multiple Impact Equipment, Shock and Vibration 2019, 5139137, doi:10.1155/2019/5139137"
    ),
    "liang-zeger-1986": (
        "K.-Y. Liang, S. L. Zeger, Longitudinal Data Analysis Using Generalized Linear Models, Biometrika 73 (1986) "
        "13-22, doi:10.1093/biomet/73.1.13"
    ),
    "foreman-mackey-2013": (
        "D. Foreman-Mackey, D. W. Hogg, D. Lang, J. Goodman, emcee: The MCMC Hammer, Publications of the Astronomical "
        "Society of the Pacific 125 (2013) 306-312, doi:10.1086/670067"
    ),
    "ribatet-2012": (
        "M. Ribatet, D. Cooley, A. C. Davison, Bayesian Inference from Composite Likelihoods, with an Application to "
        "Spatial Extremes, Statistica Sinica 22 (2012) 813-845, doi:10.5705/ss.2009.248"
    ),
    "bell-mccaffrey-2002": (
        "R. M. Bell, D. F. McCaffrey, Bias Reduction in Standard Errors for Linear Regression with Multi-Stage "
        "Samples, Survey Methodology 28 (2002) 169-181"
    ),
    "raue-2009": (
        "A. Raue et al., Structural and Practical Identifiability Analysis of Partially Observed Dynamical Models by "
        "Exploiting the Profile Likelihood, Bioinformatics 25 (2009) 1923-1929, doi:10.1093/bioinformatics/btp358"
    ),
    "hunt-crossley-1975": (
        "K. H. Hunt, F. R. E. Crossley, Coefficient of Restitution Interpreted as Damping in "
        "Vibroimpact, Journal of Applied Mechanics 42 (1975) 440-445, doi:10.1115/1.3423596"
    ),
    "palmgren": (
        "A. Palmgren, Ball and Roller Bearing Engineering, 3rd ed., Burbank, Philadelphia 1959; in the "
        "form of eqs (2)-(4) of Li & Ma 2019 with the equivalent modulus of eq (5) inverted"
    ),
    "johnson-1985": "K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, ch. 4 (Hertz), 5.6 (cylinders)",
    "herbert-mcwhannell-1977": (
        "R. G. Herbert, D. C. McWhannell, Shape and Frequency Composition of Pulses From an Impact Pair, Journal of "
        "Engineering for Industry 99 (1977) 513-518, doi:10.1115/1.3439270"
    ),
    "lee-wang-1983": (
        "T. W. Lee, A. C. Wang, On the Dynamics of Intermittent-Motion Mechanisms, part 1, Journal of Mechanisms, "
        "Transmissions and Automation in Design 105 (1983) 534-540, doi:10.1115/1.3267392"
    ),
    "lankarani-nikravesh-1990": (
        "H. M. Lankarani, P. E. Nikravesh, A Contact Force Model With Hysteresis Damping for Impact Analysis of "
        "Multibody Systems, Journal of Mechanical Design 112 (1990) 369-376, doi:10.1115/1.2912617"
    ),
    "gonthier-2004": (
        "Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedboeuf, A Regularized Contact Model with Asymmetric Damping and "
        "Dwell-Time Dependent Friction, Multibody System Dynamics 11 (2004) 209-233, "
        "doi:10.1023/B:MUBO.0000029392.21648.bc"
    ),
    "zhiying-qishao-2006": (
        "Q. Zhiying, L. Qishao, Analysis of impact process based on restitution coefficient, Journal of Dynamics and "
        "Control 4 (2006) 294-298 (reference from memory)"
    ),
    "flores-2011": (
        "P. Flores, M. Machado, M. T. Silva, J. M. Martins, On the continuous contact force models for soft materials "
        "in multibody dynamics, Multibody System Dynamics 25 (2011) 357-375, doi:10.1007/s11044-010-9237-4"
    ),
    "gharib-hurmuzlu-2012": (
        "M. Gharib, Y. Hurmuzlu, A New Contact Force Model for Low Coefficient of Restitution Impact, Journal of "
        "Applied Mechanics 79 (2012) 064506, doi:10.1115/1.4006494"
    ),
    "hu-guo-2015": (
        "S. Hu, X. Guo, A dissipative contact force model for impact analysis in multibody dynamics, Multibody System "
        "Dynamics 35 (2015) 131-151, doi:10.1007/s11044-015-9453-z"
    ),
    "carvalho-martins-2019": (
        "A. S. Carvalho, J. M. Martins, Exact restitution and generalizations for the Hunt-Crossley contact model, "
        "Mechanism and Machine Theory 139 (2019) 174-194, doi:10.1016/j.mechmachtheory.2019.03.028"
    ),
    "safaeifar-farshidianfar-2020": (
        "H. Safaeifar, A. Farshidianfar, A new model of the contact force for the collision between two solid bodies, "
        "Multibody System Dynamics 50 (2020) 233-257, doi:10.1007/s11044-020-09732-2"
    ),
    "anagnostopoulos-1988": (
        "S. A. Anagnostopoulos, Pounding of buildings in series during earthquakes, Earthquake Engineering and "
        "Structural Dynamics 16 (1988) 443-456, doi:10.1002/eqe.4290160311"
    ),
    "tsuji-1992": (
        "Y. Tsuji, T. Tanaka, T. Ishida, Lagrangian numerical simulation of plug flow of cohesionless particles in a "
        "horizontal pipe, Powder Technology 71 (1992) 239-250, doi:10.1016/0032-5910(92)88030-L; alpha: D. Antypov, "
        "J. A. Elliott, On an analytical solution for the damped Hertzian spring, EPL 94 (2011) 50004"
    ),
    "jankowski-2006": (
        "R. Jankowski, Analytical expression between the impact damping ratio and the coefficient of restitution in "
        "the non-linear viscoelastic model of structural pounding, Earthquake Engineering and Structural Dynamics 35 "
        "(2006) 517-524, doi:10.1002/eqe.537; the model: 34 (2005) 595-611, doi:10.1002/eqe.434"
    ),
    "kuwabara-kono-1987": (
        "G. Kuwabara, K. Kono, Restitution Coefficient in a Collision between Two Spheres, Japanese Journal of Applied "
        "Physics 26 (1987) 1230-1233, doi:10.1143/JJAP.26.1230; N. V. Brilliantov et al., Model for collisions in "
        "granular gases, Physical Review E 53 (1996) 5382-5392"
    ),
    "radzimovsky-1953": (
        "E. I. Radzimovsky, Stress distribution and strength condition of two rolling cylinders pressed together, "
        "University of Illinois Engineering Experiment Station, Bulletin 408, 1953"
    ),
    "dubowsky-freudenstein-1971": (
        "S. Dubowsky, F. Freudenstein, Dynamic Analysis of Mechanical Systems With Clearances, parts 1 and 2, Journal "
        "of Engineering for Industry 93 (1971) 305-316"
    ),
    "lankarani-nikravesh-1994": (
        "H. M. Lankarani, P. E. Nikravesh, Continuous contact force models for impact analysis in multibody systems, "
        "Nonlinear Dynamics 5 (1994) 193-207, doi:10.1007/BF00045676"
    ),
    "pereira-2015": (
        "C. Pereira, A. Ramalho, J. Ambrosio, An enhanced cylindrical contact force model, Multibody System Dynamics "
        "35 (2015) 277-298, doi:10.1007/s11044-015-9463-x"
    ),
    "thornton-1997": (
        "C. Thornton, Coefficient of Restitution for Collinear Collisions of Elastic-Perfectly Plastic Spheres, "
        "Journal of Applied Mechanics 64 (1997) 383-386, doi:10.1115/1.2787319"
    ),
    "jackson-green-2005": (
        "R. L. Jackson, I. Green, A Finite Element Study of Elasto-Plastic Hemispherical Contact Against a Rigid Flat, "
        "Journal of Tribology 127 (2005) 343-354, doi:10.1115/1.1866166; its force as in an open code of H. Ghaednia, "
        "M. R. W. Brake, M. Berryhill, R. L. Jackson, Strain Hardening From Elastic-Perfectly Plastic to Perfectly "
        "Elastic Flattening Single Asperity Contact, Journal of Tribology 2019"
    ),
    "green-2005": (
        "I. Green, Poisson ratio effects and critical values in spherical and cylindrical Hertzian contacts, "
        "International Journal of Applied Mechanics and Engineering 10 (2005) 451-462"
    ),
    "graff-1975": "K. F. Graff, Wave Motion in Elastic Solids, Clarendon Press 1975, section 8.2 (Pochhammer, Chree)",
    "love-1927": "A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed., Cambridge 1927, s. 278",
    "kolsky-1963": "H. Kolsky, Stress Waves in Solids, Dover, New York 1963, ch. III (bars)",
    "hairer-1993": (
        "E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., "
        "Springer 1993, sections II.5-II.6 (DOP853)"
    ),
    "takahasi-mori-1974": (
        "H. Takahasi, M. Mori, Double Exponential Formulas for Numerical Integration, Publ. RIMS "
        "Kyoto Univ. 9 (1974) 721-741"
    ),
    "schwager-poschel-2007": (
        "T. Schwager, T. Poschel, Coefficient of restitution and linear-dashpot model revisited, "
        "Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z"
    ),
    "emmerich-korn-1987": (
        "H. Emmerich, M. Korn, Incorporation of attenuation into time-domain computations of seismic wave "
        "fields, Geophysics 52 (1987) 1252-1264, doi:10.1190/1.1442386"
    ),
    "van-loan-1978": (
        "C. F. Van Loan, Computing Integrals Involving the Matrix Exponential, IEEE Transactions on "
        "Automatic Control 23 (1978) 395-404"
    ),
    "smallwood-1981": (
        "D. O. Smallwood, An improved recursive formula for calculating shock response spectra, Shock and "
        "Vibration Bulletin 51 (1981) 211-217"
    ),
    "smallwood-nord-1974": (
        "D. O. Smallwood, A. R. Nord, Matching Shock Spectra with Sums of Decaying Sinusoids Compensated for Shaker "
        "Velocity and Displacement Limitations, Shock and Vibration Bulletin 44, part 3 (1974) 43-56 (reference from "
        "memory; the method as in the code of SDynPy, Sandia National Laboratories, sum_decayed_sines)"
    ),
    "irvine-wavelets": (
        "T. Irvine, wavelets of an odd number of half-sines with no net velocity and displacement: code "
        "DSS_waveform_reconstruction.m, ver 1.3, vibrationdata.com"
    ),
    "iso-18431-4": (
        "ISO 18431-4:2007, Mechanical vibration and shock - Signal processing - Part 4: Shock-response spectrum "
        "analysis"
    ),
    "iso-18571": (
        "ISO/TS 18571:2014, 2024, Road vehicles - Objective rating metric for non-ambiguous signals (contents seen, "
        "its equations as objective-rating-metrics 1.3 (TU Graz, pypi.org/project/objective-rating-metrics) has them)"
    ),
    "mallows-1973": "C. L. Mallows, Some Comments on C_P, Technometrics 15 (1973) 661-675",
    "efron-1979": "B. Efron, Bootstrap Methods: Another Look at the Jackknife, Annals of Statistics 7 (1979) 1-26",
    "siegel-1982": ("A. F. Siegel, Robust regression using repeated medians, Biometrika 69 (1982) 242-244"),
    "rosner-1983": (
        "B. Rosner, Percentage points for a generalized ESD many-outlier procedure, Technometrics 25 (1983) 165-172"
    ),
    "croux-1992": (
        "C. Croux, P. J. Rousseeuw, Time-efficient algorithms for two highly robust estimators of scale, Computational "
        "Statistics 1 (1992) 411-428"
    ),
    "sen-1968": (
        "P. K. Sen, Estimates of the regression coefficient based on Kendall's tau, Journal of the American "
        "Statistical Association 63 (1968) 1379-1389"
    ),
    "jcgm-100": (
        "JCGM 100:2008, Evaluation of measurement data - Guide to the expression of uncertainty in measurement"
    ),
    "jcgm-101": (
        "JCGM 101:2008, Evaluation of measurement data - Supplement 1 to the Guide to the expression of uncertainty in "
        "measurement - Propagation of distributions using a Monte Carlo method"
    ),
    "jcgm-106": (
        "JCGM 106:2012, Evaluation of measurement data - The role of measurement uncertainty in conformity assessment"
    ),
    "iso-14253-1": (
        "ISO 14253-1:2017, Inspection by measurement of workpieces and measuring equipment - Part 1: Decision rules "
        "for verifying conformity or nonconformity with specifications"
    ),
    "vangel-1996": (
        "M. G. Vangel, Confidence intervals for a normal coefficient of variation, The American Statistician "
        "50 (1996) 21-26"
    ),
    "nist-handbook": (
        "NIST/SEMATECH e-Handbook of Statistical Methods, 7.2.6.3 Tolerance intervals for a normal distribution, "
        "doi:10.18434/M32189"
    ),
    "piersol-2009": (
        "T. L. Paez, A. G. Piersol (eds.), Harris' Shock and Vibration Handbook, 6th ed., McGraw-Hill 2009, ch. 20: "
        "normal tolerance limits of spectra (reference from memory)"
    ),
    "wilks-1941": (
        "S. S. Wilks, Determination of Sample Sizes for Setting Tolerance Limits, The Annals of Mathematical "
        "Statistics 12 (1941) 91-96, doi:10.1214/aoms/1177731788"
    ),
    "saltelli-2010": (
        "A. Saltelli, P. Annoni, I. Azzini, F. Campolongo, M. Ratto, S. Tarantola, Variance based sensitivity analysis "
        "of model output, Computer Physics Communications 181 (2010) 259-270, doi:10.1016/j.cpc.2009.09.018"
    ),
    "joe-kuo-2008": (
        "S. Joe, F. Y. Kuo, Constructing Sobol Sequences with Better Two-Dimensional Projections, SIAM Journal on "
        "Scientific Computing 30 (2008) 2635-2654, doi:10.1137/070709359 (direction numbers, as scipy has them)"
    ),
    "blatman-sudret-2011": (
        "G. Blatman, B. Sudret, Adaptive sparse polynomial chaos expansion based on least angle regression, Journal of "
        "Computational Physics 230 (2011) 2345-2367, doi:10.1016/j.jcp.2010.12.021 (abstract read)"
    ),
    "sudret-2008": (
        "B. Sudret, Global sensitivity analysis using polynomial chaos expansions, Reliability Engineering & System "
        "Safety 93 (2008) 964-979, doi:10.1016/j.ress.2007.04.002 (from memory)"
    ),
    "friedman-1991": (
        "J. H. Friedman, Multivariate Adaptive Regression Splines, The Annals of Statistics 19 (1991) 1-67, "
        "doi:10.1214/aos/1176347963 (from memory)"
    ),
    "kelley-1935": (
        "T. L. Kelley, An Unbiased Correlation Ratio Measure, Proceedings of the National Academy of Sciences 21 "
        "(1935) 554-559 (from memory)"
    ),
    "efron-stein-1981": (
        "B. Efron, C. Stein, The Jackknife Estimate of Variance, The Annals of Statistics 9 (1981) 586-596 "
        "(from memory)"
    ),
    "storn-price-1997": (
        "R. Storn, K. Price, Differential Evolution: A Simple and Efficient Heuristic for Global Optimization over "
        "Continuous Spaces, Journal of Global Optimization 11 (1997) 341-359, doi:10.1023/A:1008202821328 (from memory)"
    ),
    "deb-2000": (
        "K. Deb, An efficient constraint handling method for genetic algorithms, Computer Methods in Applied Mechanics "
        "and Engineering 186 (2000) 311-338, doi:10.1016/S0045-7825(99)00389-8 (from memory)"
    ),
    "ozaki-2022": (
        "Y. Ozaki, Y. Tanigaki, S. Watanabe, M. Nomura, M. Onishi, Multiobjective Tree-Structured Parzen Estimator, "
        "Journal of Artificial Intelligence Research 73 (2022) 1209-1250, doi:10.1613/jair.1.13188 (from memory)"
    ),
    "akiba-2019": (
        "T. Akiba, S. Sano, T. Yanase, T. Ohta, M. Koyama, Optuna: A Next-generation Hyperparameter Optimization "
        "Framework, KDD 2019, 2623-2631, doi:10.1145/3292500.3330701 (from memory)"
    ),
    "sacks-1989": (
        "J. Sacks, W. J. Welch, T. J. Mitchell, H. P. Wynn, Design and Analysis of Computer Experiments, Statistical "
        "Science 4 (1989) 409-423, doi:10.1214/ss/1177012413 (from memory)"
    ),
    "dubrule-1983": (
        "O. Dubrule, Cross Validation of Kriging in a Unique Neighborhood, Mathematical Geology 15 (1983) 687-699, "
        "doi:10.1007/BF01033232 (from memory)"
    ),
    "jones-1998": (
        "D. R. Jones, M. Schonlau, W. J. Welch, Efficient Global Optimization of Expensive Black-Box Functions, "
        "Journal of Global Optimization 13 (1998) 455-492, doi:10.1023/A:1008306431147 (from memory)"
    ),
    "chinneck-dravnieks-1991": (
        "J. W. Chinneck, E. W. Dravnieks, Locating Minimal Infeasible Constraint Sets in Linear Programs, ORSA Journal "
        "on Computing 3 (1991) 157-168, doi:10.1287/ijoc.3.2.157 (from memory)"
    ),
    "clopper-pearson-1934": (
        "C. J. Clopper, E. S. Pearson, The use of confidence or fiducial limits illustrated in the case of the "
        "binomial, Biometrika 26 (1934) 404-413, doi:10.1093/biomet/26.4.404 (from memory)"
    ),
    "mckay-1979": (
        "M. D. McKay, R. J. Beckman, W. J. Conover, A Comparison of Three Methods for Selecting Values of Input "
        "Variables in the Analysis of Output from a Computer Code, Technometrics 21 (1979) 239-245, "
        "doi:10.1080/00401706.1979.10489755 (from memory)"
    ),
    "jansen-1999": (
        "M. J. W. Jansen, Analysis of variance designs for model output, Computer Physics Communications 117 (1999) "
        "35-43, doi:10.1016/S0010-4655(98)00154-4"
    ),
    "sae-j211": ("SAE J211-1, Instrumentation for impact test, part 1: electronic instrumentation, appendix C"),
    "gray-2000": (
        "G. T. Gray III, Classic Split-Hopkinson Pressure Bar Testing, ASM Handbook 8, Mechanical Testing and "
        "Evaluation, ASM International 2000 (reference as quoted in open codes that cite it)"
    ),
    "follansbee-frantz-1983": (
        "P. S. Follansbee, C. Frantz, Wave Propagation in the Split Hopkinson Pressure Bar, Journal of Engineering "
        "Materials and Technology 105 (1983) 61-66 (reference from memory)"
    ),
    "yang-shim-2005": (
        "L. M. Yang, V. P. W. Shim, An analysis of stress uniformity in split Hopkinson bar test specimens, "
        "International Journal of Impact Engineering 31 (2005) 129-150, doi:10.1016/j.ijimpeng.2003.09.002"
    ),
    "ravichandran-subhash-1994": (
        "G. Ravichandran, G. Subhash, Critical Appraisal of Limiting Strain Rates for Compression Testing of Ceramics "
        "in a Split Hopkinson Pressure Bar, Journal of the American Ceramic Society 77 (1994) 263-267 (from memory)"
    ),
    "bacon-1998": (
        "C. Bacon, An experimental method for considering dispersion and attenuation in a viscoelastic Hopkinson bar, "
        "Experimental Mechanics 38 (1998) 242-249 (reference as quoted in an open list of literature)"
    ),
    "togami-1996": (
        "W. A. Togami, W. E. Baker, M. J. Forrestal, A Split Hopkinson Bar Technique to Evaluate the Performance of "
        "Accelerometers, Journal of Applied Mechanics 63 (1996) 353-356 (reference from memory)"
    ),
    "sandia-2009": (
        "Sandia National Laboratories, A modified Hopkinson pressure bar experiment to evaluate a damped "
        "piezoresistive MEMS accelerometer, SAND2009-1435C, SEM Annual Conference, Albuquerque 2009 (abstract read, "
        "osti.gov/biblio/950651)"
    ),
    "maeda-1985": (
        "N. Maeda, A method for reading and checking phase times in auto-processing system of seismic wave data, Zisin "
        "38 (1985) 365-379, doi:10.4294/zisin1948.38.3_365 (reference as quoted in open codes that cite it)"
    ),
    "gent-lindley-1959": (
        "A. N. Gent, P. B. Lindley, The Compression of Bonded Rubber Blocks, Proceedings of the Institution of "
        "Mechanical Engineers 173 (1959) 111-122, doi:10.1243/pime_proc_1959_173_022_02 (its appendix I as quoted in "
        "R. Holland, Seismic Isolation Bearing Design, github.com/rivt-info/rivt-example-04)"
    ),
    "timoshenko-goodier-1970": (
        "S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed., McGraw-Hill, New York 1970, art. 32 "
        "(rotating discs; the tests integrate the equilibrium of the disc)"
    ),
    "patera-1984": (
        "A. T. Patera, A spectral element method for fluid dynamics: laminar flow in a channel expansion, "
        "Journal of Computational Physics 54 (1984) 468-488"
    ),
    "rodgers-2009": (
        "B. Rodgers, S. Goyal, G. Kelly, M. Sheehy, The Dynamics of Multiple Pair-Wise Collisions in a Chain for "
        "Designing Optimal Shock Amplifiers, Shock and Vibration 16 (2009) (abstract and introduction read, "
        "1library.net/document/yr3edvjy-online-full-text.html)"
    ),
    "duan-2023": (
        "Z. Duan, Q. Zeng, D. Tang, Y. Peng, Theoretical and experimental study of the superelastic collision effects "
        "used to excite high-g shock environment, Scientific Reports 13 (2023) 2291, doi:10.1038/s41598-023-29538-4"
    ),
    "galperin-2003": (
        "G. Galperin, Playing Pool with pi (the Number pi from a Billiard Point of View), Regular and Chaotic Dynamics "
        "8 (2003) 375-394, doi:10.1070/RD2003v008n04ABEH000252 (reference and result as quoted in open notes)"
    ),
    "mcnamara-young-1992": (
        "S. McNamara, W. R. Young, Inelastic collapse and clumping in a one-dimensional granular medium, Physics of "
        "Fluids A 4 (1992) 496 (reference as quoted in an open list of literature)"
    ),
    "rohrbach-2012": (
        "Z. J. Rohrbach, T. R. Buresh, M. J. Madsen, Modeling the exit velocity of a compressed air cannon, American "
        "Journal of Physics 80 (2012) 24-26, doi:10.1119/1.3644253"
    ),
    "phan-duong-2024": (
        "B. B. Phan, V. Y. Duong, Determining impact velocity in an impact tester using a mathematical model, Journal "
        "of Science and Technique 19 (2024), no. 3, 32 (abstract and introduction read, "
        "tailieu.vn/doc/impact-velocity-mathematical-model-impact-tester-2878230.html)"
    ),
    "siegel-1965": "A. E. Siegel, The Theory of High Speed Guns, AGARDograph 91, NATO 1965 (reference from memory)",
    "walker-1988": (
        "J. Walker, The Amateur Scientist: Drop two stacked balls from waist height; the top ball may bounce up to the "
        "ceiling, Scientific American, October 1988"
    ),
    "iso-148-2": (
        "ISO 148-2:2016, Metallic materials - Charpy pendulum impact test - Part 2: Verification of testing machines "
        "(title and contents read, scribd.com/document/469032508; formulas: the swing of a rigid body)"
    ),
    "iso-16063-22": (
        "ISO 16063-22:2005, Methods for the calibration of vibration and shock transducers - Part 22: Shock "
        "calibration by comparison to a reference transducer (its table of devices seen on a maker's page)"
    ),
    "mil-s-901d": (
        "MIL-S-901D, Shock Tests, H.I. (High-Impact) Shipboard Machinery, Equipment, and Systems, Requirements for, "
        "1989 (weight and height of the light-weight hammer seen in a maker's text)"
    ),
    "endevco-tp-321": "Endevco TP 321, Acceleration levels of dropped objects",
    "en-166": "EN 166:2001, Personal eye-protection - Specifications (ball and speed seen in a maker's sheet)",
    "jesd22-b111": (
        "JEDEC JESD22-B111A:2016, Board Level Drop Test Method of Components for Handheld Electronic Products "
        "(scope read, filesbase.org/home/93564-EIA-JESD-22-B111A-2016.html; condition B, 1500 g and 0.5 ms, as quoted "
        "in open notes on the reliability of packages)"
    ),
    "flanagan-belytschko-1981": (
        "D. P. Flanagan, T. Belytschko, A uniform strain hexahedron and quadrilateral with orthogonal hourglass "
        "control, International Journal for Numerical Methods in Engineering 17 (1981) 679-706, "
        "doi:10.1002/nme.1620170504"
    ),
    "hughes-winget-1980": (
        "T. J. R. Hughes, J. Winget, Finite rotation effects in numerical integration of rate constitutive equations "
        "arising in large-deformation analysis, International Journal for Numerical Methods in Engineering 15 (1980) "
        "1862-1867 (reference and update as quoted in open codes that cite it)"
    ),
    "cundall-1976": (
        "P. A. Cundall, Explicit finite-difference methods in geomechanics, Numerical Methods in Engineering, "
        "Proceedings of the EF Conference on Numerical Methods in Geomechanics, Blacksburg 1976, volume 1, 132-150 "
        "(from memory)"
    ),
    "barnes-1999": (
        "M. R. Barnes, Form finding and analysis of tension structures by dynamic relaxation, International Journal of "
        "Space Structures 14 (1999) 89-104"
    ),
    "lysmer-kuhlemeyer-1969": (
        "J. Lysmer, R. L. Kuhlemeyer, Finite dynamic model for infinite media, Journal of the Engineering Mechanics "
        "Division ASCE 95 (1969) 859-877"
    ),
    "johnson-cook-1983": (
        "G. R. Johnson, W. H. Cook, A constitutive model and data for metals subjected to large strains, high strain "
        "rates and high temperatures, 7th International Symposium on Ballistics, The Hague 1983, 541-547"
    ),
    "jesd22-b104": (
        "JEDEC JESD22-B104C:2004, Mechanical Shock (scope read, lab.atengineer.com/kikaku/jesd22b104c.htm; condition "
        "B, 1500 g and 0.5 ms, as quoted in open notes; equivalent drop heights: v^2/(2 g) of the half sine)"
    ),
    "iec-60068-2-27": (
        "IEC 60068-2-27:2008, Environmental testing - Part 2-27: Tests - Test Ea and guidance: Shock (its "
        "severities from memory)"
    ),
    "mindlin-1945": (
        "R. D. Mindlin, Dynamics of Package Cushioning, Bell System Technical Journal 24 (1945) 353-461 (abstract "
        "seen; formulas from memory)"
    ),
    "stulov-2004": (
        "A. Stulov, Mechanical Features of Piano Hammer Felt, 21st International Congress of Theoretical and Applied "
        "Mechanics, Warsaw 2004 (summary seen; the three-parameter law in J. O. Smith, Physical Audio Signal "
        "Processing)"
    ),
    "gibson-ashby-1997": (
        "L. J. Gibson, M. F. Ashby, Cellular Solids: Structure and Properties, 2nd ed., Cambridge University Press "
        "1997 (formulas of the densification from memory)"
    ),
    "maw-barber-fawcett": (
        "N. Maw, J. R. Barber, J. N. Fawcett, The Role of Elastic Tangential Compliance in Oblique Impact, Journal of "
        "Lubrication Technology 103 (1981) 74-80 (abstract read: steel and rubber; the coefficient 0.12 read in part "
        "of a text on their pucks, the material of the puck not seen)"
    ),
    "molinari-1999": (
        "A. Molinari, Y. Estrin, S. Mercier, Dependence of the Coefficient of Friction on the Sliding Conditions in "
        "the High Velocity Range, Journal of Tribology 121 (1999) 35-41, doi:10.1115/1.2833808 (abstract read)"
    ),
    "zerilli-armstrong-1987": (
        "F. J. Zerilli, R. W. Armstrong, Dislocation-mechanics-based constitutive relations for material dynamics "
        "calculations, Journal of Applied Physics 61 (1987) 1816 (abstract read; constants of copper as quoted in the "
        "tests of Sandia's lgrtk)"
    ),
}
"""References by key: what is marked "from memory" was found in no text that could be opened, and its pages may be
wrong; "as quoted" says that others print it so, "read" what was opened of the source itself."""


def citation(key: str) -> str:
    """Return the full reference of a key.

    Raises
    ------
    InputError
        If the key is unknown.

    Examples
    --------
    >>> citation("johnson-1985").startswith("K. L. Johnson")
    True
    """
    if key not in SOURCES:
        raise InputError("citation", key, "a known source", nearest(key, SOURCES))
    return SOURCES[key]
