!> Viscous dampers between the foundation and the corners of the base, one at each corner.
!>
!> The damper under the corner that lifts is drawn out by the chord 4b sin(phi/2); the other one is
!> at rest. Virtual work turns its force c d(stroke)/dt into the moment c (2b cos(phi/2))**2 phi'
!> against the motion.
module rwmf_model_effects_corner_damper
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t
   use rwmf_model_kinematics, only: kinematics_t
   use rwmf_problem_case, only: case_t, damper_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: real_of
   use rwmf_problem_key, only: not_negative, required
   implicit none
   private

   public :: damper_group
   public :: add_damper, damper_power, damper_force

contains

   type(case_group_t) function damper_group() result(group)
      group%name = 'damper'
      group%needs(1) = 'wall'
      group%reasons(1) = 'dampers work under its corners'
      group%keys = [required('damper', 'c_over_m_w', 'real', '1/s', not_negative, &
         'viscous damper under each corner of the base: its constant over m_w')]
      group%fill => fill_damper
      group%is_present => has_damper
   end function damper_group

   subroutine fill_damper(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      case%damper = damper_t(real_of(case%values, 'damper', 'c_over_m_w'))
   end subroutine fill_damper

   pure logical function has_damper(case)
      type(case_t), intent(in) :: case

      has_damper = allocated(case%damper)
   end function has_damper

   !> Part of the damper in the equation of motion.
   subroutine add_damper(equation, t, y, kin, inertia, moment, y_dot)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(equation%n)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment
      real(wp), intent(inout) :: y_dot(equation%n)

      moment = moment - damping(equation, kin%half_cosine)*equation%side*y(2)
   end subroutine add_damper

   !> Power that it takes [W/kg].
   real(wp) function damper_power(equation, t, y) result(power)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)

      power = equation%p%R**2*damping(equation, cos(y(1)/2))*y(2)**2
   end function damper_power

   !> Force on the lifting corner, against its velocity along the chord.
   subroutine damper_force(equation, t, y, y_ddot, force)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_ddot
      real(wp), intent(inout) :: force(2)
      real(wp) :: half_angle
      !! of the chord from the vertical, as well [rad]
      real(wp) :: stroke_rate
      !! [m/s]

      half_angle = equation%side*y(1)/2
      stroke_rate = 2*equation%p%R*equation%sin_alpha*cos(half_angle)*equation%side*y(2)
      force = force - equation%damper_c*stroke_rate*[equation%side*sin(half_angle), &
         cos(half_angle)]
   end subroutine damper_force

   !> Damping moment per unit m_w R**2 and angular velocity [1/s].
   pure real(wp) function damping(equation, half_cosine)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: half_cosine
      !! cos(phi/2) [-]

      damping = equation%damper_c*(2*equation%sin_alpha*half_cosine)**2
   end function damping

end module rwmf_model_effects_corner_damper
