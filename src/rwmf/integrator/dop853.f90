!> Dormand and Prince's explicit Runge-Kutta method of order 8 with error estimators of orders 5
!> and 3. Coefficients: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.5.
module rwmf_integrator_dop853
   use rwmf_core_kinds, only: wp
   use rwmf_integrator_one_step, only: one_step_t
   use rwmf_model_assembly, only: rhs
   implicit none
   private

   public :: dop853_t

   !> Order 8 with 12 stages.
   type, extends(one_step_t) :: dop853_t
   contains
      procedure :: attempt => attempt_dop853
   end type dop853_t

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
      -8.149787010746927_wp, -18.52006565999696_wp, 22.739487099350505_wp, 2.4936055526796523_wp, &
      -3.0467644718982196_wp, &
      2.273310147516538_wp, 0.0_wp, 0.0_wp, -10.53449546673725_wp, -2.0008720582248625_wp, &
      -17.9589318631188_wp, 27.94888452941996_wp, -2.8589982771350235_wp, -8.87285693353063_wp, &
      12.360567175794303_wp, 0.6433927460157636_wp]
   !! weights of the stages before, stage by stage from the second on
   real(wp), parameter :: b(s) = [0.054293734116568765_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      4.450312892752409_wp, 1.8915178993145003_wp, -5.801203960010585_wp, 0.3111643669578199_wp, &
      -0.1521609496625161_wp, 0.20136540080403034_wp, 0.04471061572777259_wp]
   real(wp), parameter :: e3(s) = [-0.18980075407240762_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      4.450312892752409_wp, 1.8915178993145003_wp, -5.801203960010585_wp, -0.4226823213237919_wp, &
      -0.1521609496625161_wp, 0.20136540080403034_wp, 0.02265179219836082_wp]
   real(wp), parameter :: e5(s) = [0.01312004499419488_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
      -1.2251564463762044_wp, -0.4957589496572502_wp, 1.6643771824549864_wp, &
      -0.35032884874997366_wp, 0.3341791187130175_wp, 0.08192320648511571_wp, &
      -0.022355307863886294_wp]

contains

   subroutine attempt_dop853(self, t, y, f, h, y_new, error)
      class(dop853_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: f(:)
      real(wp), intent(in) :: h
      real(wp), intent(out) :: y_new(:)
      real(wp), intent(out) :: error
      real(wp) :: k(size(y), s)
      integer :: i

      self%error_order = 8
      k(:, 1) = f
      do i = 2, s
         call rhs(self%equation, t + c(i)*h, &
            y + h*combine(a((i - 1)*(i - 2)/2 + 1:i*(i - 1)/2), k), k(:, i))
      end do
      y_new = y + h*combine(b, k)
      error = estimate(self, y, y_new, h, k)
   end subroutine attempt_dop853

   !> Weighted sum of stages, in a fixed order.
   pure function combine(weights, k) result(total)
      real(wp), intent(in) :: weights(:)
      real(wp), intent(in) :: k(:, :)
      real(wp) :: total(size(k, 1))
      integer :: j

      total = weights(1)*k(:, 1)
      do j = 2, size(weights)
         total = total + weights(j)*k(:, j)
      end do
   end function combine

   !> Hairer's combination of the estimators of orders 5 and 3.
   pure real(wp) function estimate(self, y, y_new, h, k) result(error)
      class(dop853_t), intent(in) :: self
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_new(:)
      real(wp), intent(in) :: h
      real(wp), intent(in) :: k(:, :)
      real(wp) :: scale(size(y))
      real(wp) :: square_5
      real(wp) :: square_3

      scale = self%tolerance%atol + self%tolerance%rtol*max(abs(y), abs(y_new))
      square_5 = sum((combine(e5, k)/scale)**2)
      square_3 = sum((combine(e3, k)/scale)**2)
      error = 0
      if (square_5 > 0) error = abs(h)*square_5/sqrt(size(y)*(square_5 + 0.01_wp*square_3))
   end function estimate

end module rwmf_integrator_dop853
