!> Elongation that relates a tendon's stiffness to its forces at theta = 0 and theta = alpha.
module rwmf_problem_tendon_stroke
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: elongation_at_alpha

contains

   !> Elongation at theta = alpha of a tendon on the axis: b alpha for Eq. (1), else that of a
   !> straight tendon [m].
   pure real(wp) function elongation_at_alpha(law, h, b, height) result(elongation)
      character(*), intent(in) :: law
      !! 'linear' or 'truss'
      real(wp), intent(in) :: h
      !! half height of the wall [m]
      real(wp), intent(in) :: b
      !! half width of the wall [m]
      real(wp), intent(in) :: height
      !! height of the upper anchor [m]
      real(wp) :: alpha

      alpha = atan2(b, h)
      elongation = b*alpha
      if (law == 'truss') elongation = sqrt(height**2 + 2*b**2*(1 - cos(alpha)) &
         + 2*height*b*sin(alpha)) - height
   end function elongation_at_alpha

end module rwmf_problem_tendon_stroke
