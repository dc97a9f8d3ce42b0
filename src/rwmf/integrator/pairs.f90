!> Explicit Runge-Kutta pairs and their coefficients.
module rwmf_integrator_pairs
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: pair_t, sum_t, most_stages, most_terms, sum_of, step_tolerance
   public :: dormand_prince_853, tsitouras_papakostas_64

   integer, parameter :: most_stages = 12
   integer, parameter :: most_terms = 9
   !! largest number of terms of a sum

   !> Weighted sum of stages without the terms of zero weight.
   type :: sum_t
      integer :: terms = 0
      integer :: stage(most_terms) = 1
      real(wp) :: weight(most_terms) = 0
      !! (terms) weight of each stage [-]
   end type sum_t

   !> Method with one or two embedded solutions that estimate its error.
   type :: pair_t
      integer :: stages = 1
      integer :: order = 1
      !! order of the solution
      integer :: error_order = 1
      !! the estimated local error is proportional to h**error_order
      real(wp) :: c(most_stages) = 0
      !! nodes, as fractions of the step [-]
      type(sum_t) :: a(2:most_stages)
      !! weights of the preceding stages in each stage
      type(sum_t) :: b
      !! weights of the solution
      real(wp) :: weight(most_stages) = 0
      !! weights of the solution stage by stage [-]
      type(sum_t) :: e
      !! difference of the embedded solution from the solution
      type(sum_t) :: e_low
      !! difference of a second embedded solution of lower order, for Hairer's estimator; 0 terms if
      !! absent
   end type pair_t

contains

   !> Tolerance for the estimated error of a step that keeps its true error at about rtol [-]. A
   !> solution of a higher order is more accurate than its estimate.
   pure real(wp) function step_tolerance(pair, rtol) result(tolerance)
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: rtol
      !! [-]

      real(wp), parameter :: share = 0.3_wp
      !! share of rtol for one step, because the errors of several steps add up [-]

      tolerance = rtol
      if (pair%order > pair%error_order) tolerance = (share*rtol)**(real(pair%error_order, wp) &
         /(pair%order + 1))
   end function step_tolerance

   !> Build a sum from weights.
   pure type(sum_t) function sum_of(weights) result(total)
      real(wp), intent(in) :: weights(:)
      !! (stages) factors; zeros are dropped [-]
      integer :: j, n

      n = 0
      do j = 1, size(weights)
         if (abs(weights(j)) <= 0) cycle
         n = n + 1
         total%stage(n) = j
         total%weight(n) = weights(j)
      end do
      total%terms = n
   end function sum_of

   !> Dormand and Prince's method of order 8, with error estimators of orders 5 and 3 (Hairer,
   !> Norsett, Wanner, Solving Ordinary Differential Equations I, II.5).
   pure type(pair_t) function dormand_prince_853() result(pair)
      integer, parameter :: s = 12
      !! stages
      real(wp), parameter :: c(s) = [0.0_wp, 0.05260015195876773_wp, 0.0789002279381516_wp, &
         0.1183503419072274_wp, 0.2816496580927726_wp, 1.0_wp/3, 0.25_wp, 4.0_wp/13, &
         127.0_wp/195, 0.6_wp, 6.0_wp/7, 1.0_wp]
      !! nodes
      real(wp), parameter :: a(s*(s - 1)/2) = [ &
         0.05260015195876773_wp, &
         0.0197250569845379_wp, 0.0591751709536137_wp, &
         0.02958758547680685_wp, 0.0_wp, 0.08876275643042054_wp, &
         0.2413651341592667_wp, 0.0_wp, -0.8845494793282861_wp, 0.924834003261792_wp, &
         1.0_wp/27, 0.0_wp, 0.0_wp, 0.17082860872947386_wp, 0.12546768756682242_wp, &
         19.0_wp/512, 0.0_wp, 0.0_wp, 0.17025221101954405_wp, 0.06021653898045596_wp, -9.0_wp/512, &
         0.03709200011850479_wp, 0.0_wp, 0.0_wp, 0.17038392571223998_wp, 0.10726203044637328_wp, &
         -0.015319437748624402_wp, 0.008273789163814023_wp, &
         0.6241109587160757_wp, 0.0_wp, 0.0_wp, -3.3608926294469414_wp, -0.868219346841726_wp, &
         27.59209969944671_wp, 20.154067550477894_wp, -43.48988418106996_wp, &
         0.47766253643826434_wp, 0.0_wp, 0.0_wp, -2.4881146199716677_wp, -0.590290826836843_wp, &
         21.230051448181193_wp, 15.279233632882423_wp, -33.28821096898486_wp, &
         -0.020331201708508627_wp, &
         -0.9371424300859873_wp, 0.0_wp, 0.0_wp, 5.186372428844064_wp, 1.0914373489967295_wp, &
         -8.149787010746927_wp, -18.52006565999696_wp, 22.739487099350505_wp, &
         2.4936055526796523_wp, &
         -3.0467644718982196_wp, &
         2.273310147516538_wp, 0.0_wp, 0.0_wp, -10.53449546673725_wp, -2.0008720582248625_wp, &
         -17.9589318631188_wp, 27.94888452941996_wp, -2.8589982771350235_wp, -8.87285693353063_wp, &
         12.360567175794303_wp, 0.6433927460157636_wp]
      !! weights of the preceding stages, stage by stage from the second on
      real(wp), parameter :: b(s) = [0.054293734116568765_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
         4.450312892752409_wp, 1.8915178993145003_wp, -5.801203960010585_wp, &
         0.3111643669578199_wp, &
         -0.1521609496625161_wp, 0.20136540080403034_wp, 0.04471061572777259_wp]
      real(wp), parameter :: e3(s) = [-0.18980075407240762_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
         4.450312892752409_wp, 1.8915178993145003_wp, -5.801203960010585_wp, &
         -0.4226823213237919_wp, &
         -0.1521609496625161_wp, 0.20136540080403034_wp, 0.02265179219836082_wp]
      real(wp), parameter :: e5(s) = [0.01312004499419488_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
         -1.2251564463762044_wp, -0.4957589496572502_wp, 1.6643771824549864_wp, &
         -0.35032884874997366_wp, 0.3341791187130175_wp, 0.08192320648511571_wp, &
         -0.022355307863886294_wp]
      integer :: i

      pair%stages = s
      pair%order = 8
      pair%error_order = 8
      pair%c(:s) = c
      do i = 2, s
         pair%a(i) = sum_of(a((i - 1)*(i - 2)/2 + 1:i*(i - 1)/2))
      end do
      pair%b = sum_of(b)
      pair%weight(:s) = b
      pair%e = sum_of(e5)
      pair%e_low = sum_of(e3)
   end function dormand_prince_853

   !> Tsitouras and Papakostas' pair 6(4) of seven stages (SIAM J. Sci. Comput. 20, 1999).
   pure type(pair_t) function tsitouras_papakostas_64() result(pair)
      integer, parameter :: s = 7
      !! stages
      real(wp) :: b(s)

      pair%stages = s
      pair%order = 6
      pair%error_order = 5
      pair%c(:s) = [0.0_wp, 4/27.0_wp, 2/9.0_wp, 3/7.0_wp, 11/16.0_wp, 10/13.0_wp, 1.0_wp]
      pair%a(2) = sum_of([4/27.0_wp])
      pair%a(3) = sum_of([1/18.0_wp, 1/6.0_wp])
      pair%a(4) = sum_of([66/343.0_wp, -729/1372.0_wp, 1053/1372.0_wp])
      pair%a(5) = sum_of([13339/49152.0_wp, -4617/16384.0_wp, 5427/53248.0_wp, 95207/159744.0_wp])
      pair%a(6) = sum_of([-6935/57122.0_wp, 23085/48334.0_wp, 33363360/273642941.0_wp, &
         972160/118442467.0_wp, 172687360/610434253.0_wp])
      pair%a(7) = sum_of([611/1891.0_wp, -4617/7564.0_wp, 6041007/13176488.0_wp, &
         12708836/22100117.0_wp, -35840000/62461621.0_wp, 6597591/7972456.0_wp])
      b = [131/1800.0_wp, 0.0_wp, 1121931/3902080.0_wp, 319333/1682928.0_wp, &
         262144/2477325.0_wp, 4084223/15177600.0_wp, 1891/25200.0_wp]
      pair%b = sum_of(b)
      pair%weight(:s) = b
      pair%e = sum_of(b - [2694253/26100360.0_wp, 0.0_wp, 83647323/535804360.0_wp, &
         691202281/1789061040.0_wp, -1275547648/10565208225.0_wp, 0.4_wp, 1891/25200.0_wp])
   end function tsitouras_papakostas_64

end module rwmf_integrator_pairs
