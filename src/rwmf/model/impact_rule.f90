!> Velocity factor of impacts: by the rule of `&impact rule`, and by the momentum balance.
module rwmf_model_impact_rule
   use rwmf_core_kinds, only: wp
   use rwmf_model_restitution, only: restitution_housner, restitution_momentum, restitution_t
   use rwmf_problem_scene_axes, only: walls_of
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: impact_law, restitution, balanced_restitution, mass_ratio

contains

   !> Restitution law of the case's impact rule.
   pure type(restitution_t) function impact_law(case, alpha) result(law)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: alpha
      !! slenderness [rad]

      law%e = restitution(case, alpha)
      if (case%impact%rule /= 'table') return
      law%speed = case%impact%table_theta_dot
      law%factor = case%impact%table_e
   end function impact_law

   !> Velocity factor of the case's rule, the largest one of a table [-].
   pure real(wp) function restitution(case, alpha) result(e)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: alpha
      !! slenderness [rad]

      select case (case%impact%rule)
      case ('housner')
         e = restitution_housner(alpha)
      case ('coupled')
         e = balanced_restitution(case, alpha)
      case ('table')
         e = maxval(case%impact%table_e)
      case ('constant')
         e = case%impact%e
      case default
         e = 1
      end select
   end function restitution

   !> Velocity factor e_max from the momentum balance of the whole scene, for any rule. The whole
   !> impulse acts at the new corner, without slip or bounce: the largest loss at a rigid base. For
   !> a free-standing wall it is Housner's factor [-].
   pure real(wp) function balanced_restitution(case, alpha) result(e)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: alpha
      !! slenderness [rad]
      real(wp) :: beta
      !! inertance of a corner over m_w [-]

      beta = 0
      if (allocated(case%inerter)) beta = case%inerter%inertance_over_m_w
      e = restitution_momentum(alpha, mass_ratio(case)/walls_of(case), beta)
   end function balanced_restitution

   !> Mass ratio of the frame's mass that moves with the wall, 0 without a frame or with link
   !> springs [-].
   pure real(wp) function mass_ratio(case) result(gamma)
      type(case_t), intent(in) :: case

      gamma = 0
      if (.not. allocated(case%frame)) return
      if (.not. case%frame%is_linked) return
      if (allocated(case%frame%gamma)) gamma = case%frame%gamma
   end function mass_ratio

end module rwmf_model_impact_rule
