!> Springs or smooth laws of a frame whose storeys yield one by one.
module rwmf_model_hysteresis_storey_springs
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: equation_t
   use rwmf_model_hysteresis_bouc_wen, only: new_hysteresis
   use rwmf_model_hysteresis_spring_laws, only: new_branch, new_spring
   use rwmf_problem_case, only: case_t
   use rwmf_problem_frame_strength, only: first_yield, frame_hardening, frame_law, has_branches
   implicit none
   private

   public :: choose_storey_springs

contains

   !> Create a spring or a smooth law for each storey of the frame.
   subroutine choose_storey_springs(case, k, equation)
      type(case_t), intent(in) :: case
      !! case whose frame has strength
      real(wp), intent(in) :: k(:)
      !! (storeys) elastic stiffnesses over the mass of the floors [1/s2]
      type(equation_t), intent(inout) :: equation
      !! equation with its floors. The caller sets the places of the states of smooth storeys
      real(wp) :: u_y(size(k))
      !! displacements at first yield [m]
      integer :: i

      u_y = first_yield(case, size(k))
      associate (floors => equation%floors, state => equation%state, law => frame_law(case), &
         hardening => frame_hardening(case))
         if (.not. allocated(state%storey_branches)) allocate (state%storey_branches(size(k)))
         floors%yields = .true.
         if (has_branches(case)) then
            floors%springs = new_spring(k, k*u_y, hardening, law=law)
            state%storey_branches = new_branch(floors%springs)
         else
            floors%laws = [(new_hysteresis(law, hardening, u_y(i), k(i)), i=1, size(k))]
            state%storey_branches%slope = hardening*k
            allocate (state%storey_signs(size(k)))
         end if
      end associate
   end subroutine choose_storey_springs

end module rwmf_model_hysteresis_storey_springs
