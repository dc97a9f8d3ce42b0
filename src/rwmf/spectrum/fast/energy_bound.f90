!> Energy bound of later peaks, once the ground has come to rest.
module rwmf_spectrum_fast_energy_bound
   use rwmf_core_kinds, only: wp
   use rwmf_spectrum_fast_ordinate, only: ordinate_t
   use rwmf_spectrum_fast_types, only: degree, reduced_equation_t
   implicit none
   private

   public :: is_peak_final

contains

   !> Is the largest peak so far final, with the ground at rest and the wall on its base?
   !>
   !> With f = 0 it follows from the equation of `rwmf_spectrum_fast_reduced_equation`, multiplied
   !> by exp(-2 int(Q)) v', that
   !>
   !>    v'**2/2 exp(-2 int_0^v Q) + W(v),   W = int_0^v (M1 omega_s**2 v + M3) exp(-2 int(Q))
   !>
   !> does not grow in flight (M1 > 0), in all formulations. It is v'**2/2 at v = 0 on both sides,
   !> and an impact lowers it. So v stays below v_max for good once w**2/2 < W(v_max) on both sides.
   pure logical function is_peak_final(equation, ordinate, w)
      type(reduced_equation_t), intent(in) :: equation
      type(ordinate_t), intent(in) :: ordinate
      real(wp), intent(in) :: w
      !! rate of v after an impact [1/s]
      real(wp), parameter :: safety = 1 - 1.0e-6_wp
      !! margin for the error of the integrals [-]

      is_peak_final = ordinate%v_max <= equation%v_high
      if (.not. is_peak_final) return
      is_peak_final = w**2/2 < safety*min(work(equation, 1, ordinate%stiffness, ordinate%v_max), &
         work(equation, 2, ordinate%stiffness, ordinate%v_max))
   end function is_peak_final

   !> W of a side at v [1/s2], by Gauss's rule of five points: its error is below 1e-10 of W.
   pure real(wp) function work(equation, side, stiffness, v_end)
      type(reduced_equation_t), intent(in) :: equation
      integer, intent(in) :: side
      !! 1: theta > 0, 2: theta < 0
      real(wp), intent(in) :: stiffness
      !! omega_s**2 [1/s2]
      real(wp), intent(in) :: v_end
      real(wp), parameter :: node(5) = [-0.906179845938663992797627_wp, &
         -0.538469310105683091036314_wp, 0.0_wp, 0.538469310105683091036314_wp, &
         0.906179845938663992797627_wp]
      real(wp), parameter :: weight(5) = [0.236926885056189087514264_wp, &
         0.478628670499366468041292_wp, 0.568888888888888888888889_wp, &
         0.478628670499366468041292_wp, 0.236926885056189087514264_wp]
      real(wp) :: v, m_1, m_3, integral_q
      integer :: i, j

      work = 0
      do i = 1, size(node)
         v = v_end*(1 + node(i))/2
         m_1 = 0
         m_3 = 0
         integral_q = 0
         do j = degree, 0, -1
            m_1 = m_1*v + equation%coef(j, 2, side)
            m_3 = m_3*v + equation%coef(j, 4, side)
            integral_q = integral_q*v + equation%coef(j, 1, side)/(j + 1)
         end do
         m_1 = equation%m1 + v*m_1
         m_3 = equation%m3 + v*(equation%m3_1 + m_3)
         work = work + weight(i)*(m_1*stiffness*v + m_3)*exp(-2*v*integral_q)
      end do
      work = work*v_end/2
   end function work

end module rwmf_spectrum_fast_energy_bound
